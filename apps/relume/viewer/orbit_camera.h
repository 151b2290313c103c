// Looking at an object: the camera goes around a pivot, along the image, nearer and farther.
#pragma once

#include "core/box.h"
#include "relume/scene.h"

namespace relume::viewer {

/// Height of what the image shows at a depth along the viewing direction, metres.
float view_height(const Camera& camera, float depth);

/// Depth of a point along the viewing direction, metres; negative behind the camera.
float depth_of(const CameraPose& camera, const Vec3& point);

/// Whether a point is in front of the camera and within the image. `aspect`: width over height.
bool is_on_screen(const CameraPose& camera, const Vec3& point, float aspect);

/// A pivot for a camera that has none: straight ahead at the depth of `point`, and at least at `nearest`, metres.
Vec3 pivot_ahead(const CameraPose& camera, const Vec3& point, float nearest);

/// Goes around `pivot`. `turn`: mouse movement in heights of the image, y downwards; one height is half a turn. Keeps
/// the horizon and never goes over the zenith.
void orbit(CameraPose& camera, const Vec3& pivot, const Vec2& turn);

/// Moves camera and pivot parallel to the image, so that what is at the pivot's depth follows the mouse. `by`: as for
/// orbit().
void pan(CameraPose& camera, Vec3& pivot, const Vec2& by);

/// How near to the pivot and how far from it dolly() goes, metres; of an orthographic camera, its half height.
struct DollyRange {
  float nearest = 0;
  float farthest = kInfinity;
};

/// Goes towards the pivot, or away from it where `notches` of the wheel are negative; at the pivot, back from where the
/// camera looks. A camera that is outside the range is only brought nearer to it. An orthographic camera shows less, or
/// more.
void dolly(CameraPose& camera, const Vec3& pivot, float notches, const DollyRange& range);

/// Moves the camera along its axes, so that the box fills kFramedShare (scene/framing.h) of the image in one dimension
/// and at most that in the other. `aspect`: width over height. An empty box changes nothing.
void frame_box(CameraPose& camera, const Box& box, float aspect);

}  // namespace relume::viewer
