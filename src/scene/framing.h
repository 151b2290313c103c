// Default camera: the nearest one that shows the whole object.
#pragma once

#include "scene/scene_view.h"

namespace relume {

/// Share of the image, across or down, that a framed object fills.
inline constexpr float kFramedShare = 0.88f;

/// Transform of a camera that looks along `forward` (unit, not vertical), so that what the instances show fills
/// kFramedShare of the image in one dimension and at most that in the other. `tan_half` are the tangents of half the
/// angles of view. Needs vertices, triangles, meshes and instances. `center` is the middle of the scene, and
/// the camera's position if there is no triangle.
Mat4 framing_camera(const SceneView& scene, const Vec3& forward, const Vec2& tan_half, const Vec3& center);

}  // namespace relume
