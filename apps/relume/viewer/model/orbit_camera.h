// Orbit camera: orbits a pivot, pans and dollies.
#pragma once

#include "core/box.h"
#include "relume/scene.h"

namespace relume::viewer {

/// Height of the view at a depth along the viewing direction, metres.
float view_height(const Camera& camera, float depth);

/// Depth of a point along the viewing direction, metres; negative behind the camera.
float depth_of(const CameraPose& camera, const Vec3& point);

/// Whether a point is in front of the camera and inside the image. `aspect`: width over height.
bool is_on_screen(const CameraPose& camera, const Vec3& point, float aspect);

/// Pivot for a camera without one: straight ahead at the depth of `point`, but at least at `nearest`, metres.
Vec3 pivot_ahead(const CameraPose& camera, const Vec3& point, float nearest);

/// Orbits `pivot`. `turn`: mouse movement in heights of the image, y downwards; one height is half a turn. Keeps the
/// horizon level and never crosses the zenith.
void orbit(CameraPose& camera, const Vec3& pivot, const Vec2& turn);

/// Moves camera and pivot parallel to the image, so that points at the pivot's depth follow the mouse. `by`: as for
/// orbit().
void pan(CameraPose& camera, Vec3& pivot, const Vec2& by);

/// Limits of dolly()'s distance to the pivot, metres; for an orthographic camera, of its half height.
struct DollyRange {
  float nearest = 0;
  float farthest = kInfinity;
};

/// Moves towards the pivot, or away for negative `notches` of the wheel; at the pivot, along the viewing direction. A
/// camera outside the range only moves towards it. An orthographic camera changes its height instead.
void dolly(CameraPose& camera, const Vec3& pivot, float notches, const DollyRange& range);

/// Moves the camera along its axes, so that the box fills kFramedShare (scene/framing.h) of the image in one dimension
/// and at most that in the other. `aspect`: width over height. Ignores an empty box.
void frame_box(CameraPose& camera, const Box& box, float aspect);

}  // namespace relume::viewer
