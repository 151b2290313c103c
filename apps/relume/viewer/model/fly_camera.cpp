#include "viewer/model/fly_camera.h"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace relume::viewer {
namespace {

constexpr float kFastFactor = 5;
constexpr float kSteepest_rad = 1.55f;  // just below the zenith, where the horizon would tumble

}  // namespace

void FlyCamera::place(const Mat4& to_world) {
  const Vec3 z = glm::normalize(Vec3(to_world[2]));
  const Vec3 x = glm::normalize(glm::cross(Vec3(to_world[1]), z));
  place(Vec3(to_world[3]), glm::quat_cast(Mat3(x, glm::cross(z, x), z)));
}

void FlyCamera::place(const Vec3& eye, const glm::quat& rotation) {
  eye_ = eye;
  rotation_ = glm::normalize(rotation);
}

bool FlyCamera::update(const FlyInput& input, float seconds, float fov_y_rad, float image_height_px) {
  if (input.idle()) return false;
  if (input.turn_px != Vec2(0)) {
    // Near the image centre, the point under the cursor stays there.
    turn(input.turn_px * (fov_y_rad / std::max(image_height_px, 1.0f)));
  }
  // Up and down are those of the world, so that rising while looking down does not fly forwards.
  const Vec3 direction = rotation_ * Vec3(input.move.x, 0, input.move.z) + Vec3(0, input.move.y, 0);
  eye_ += direction * (speed * (input.fast ? kFastFactor : 1.0f) * seconds);
  return true;
}

void FlyCamera::turn(const Vec2& by_rad) {
  const float pitch = std::asin(clamp(forward().y, -1.0f, 1.0f));
  const float wanted = clamp(pitch - by_rad.y, -kSteepest_rad, kSteepest_rad);
  const glm::quat yaw = glm::angleAxis(-by_rad.x, Vec3(0, 1, 0));
  const glm::quat tilt = glm::angleAxis(wanted - pitch, Vec3(1, 0, 0));
  rotation_ = glm::normalize(yaw * rotation_ * tilt);
}

Mat4 FlyCamera::to_world() const {
  Mat4 m = glm::mat4_cast(rotation_);
  m[3] = Vec4(eye_, 1);
  return m;
}

}  // namespace relume::viewer
