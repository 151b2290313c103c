// Default camera: the nearest one that shows the whole object.
#pragma once

#include "scene/scene_view.h"

namespace relume {

/// Fraction of the image, across or down, filled by a framed object.
inline constexpr float kFramedShare = 0.88f;

/// Transform of a camera along `forward` (unit, not vertical) that frames the instances. They fill kFramedShare of the
/// image in one dimension and at most that in the other. `tan_half`: tangents of half the angles of view. Needs
/// vertices, triangles, meshes and instances. `center`: middle of the scene, and the camera's position without
/// triangles.
Mat4 framing_camera(const SceneView& scene, const Vec3& forward, const Vec2& tan_half, const Vec3& center);

}  // namespace relume
