// Fly camera: keys move it, the mouse turns it.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "core/vec.h"

namespace relume::viewer {

/// User input during one frame of the interface.
struct FlyInput {
  Vec3 move{0};     ///< in the camera's axes, each in [-1, 1]: x right, y up, -z forward
  Vec2 turn_px{0};  ///< mouse movement, y downwards
  bool fast = false;
  bool idle() const { return move == Vec3(0) && turn_px == Vec2(0); }
};

class FlyCamera {
 public:
  /// Takes the position and rotation of a camera matrix; ignores its scale.
  void place(const Mat4& to_world);
  void place(const Vec3& eye, const glm::quat& rotation);

  /// Moves and turns, the latter like turn(). Returns whether the camera changed.
  bool update(const FlyInput& input, float seconds, float fov_y_rad, float image_height_px);

  /// Turns by angles, radians: to the right and down. Keeps the horizon level and never crosses the zenith.
  void turn(const Vec2& by_rad);

  Mat4 to_world() const;
  const Vec3& eye() const { return eye_; }
  const glm::quat& rotation() const { return rotation_; }
  Vec3 forward() const { return rotation_ * Vec3(0, 0, -1); }

  float speed = 1;  ///< metres per second; fast: five times as fast

 private:
  Vec3 eye_{0};
  glm::quat rotation_{1, 0, 0, 0};
};

}  // namespace relume::viewer
