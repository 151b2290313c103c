// Computes the orientation of cameras and lights.
#pragma once

#include <glm/gtc/quaternion.hpp>

#include "core/vec.h"

namespace relume {

/// Rotation of -Z to `direction`, with +Y as close to `up` as possible. A direction along `up` uses some perpendicular
/// axis; a zero-length one becomes -Z.
inline glm::quat look_rotation(const Vec3& direction, const Vec3& up = Vec3(0, 1, 0)) {
  const float length = glm::length(direction);
  const Vec3 back = length > 0 && is_finite(length) ? -direction / length : Vec3(0, 0, 1);
  Vec3 right = glm::cross(up, back);
  if (!(glm::length(right) > 1e-6f)) right = glm::cross(std::fabs(back.z) < 0.9f ? Vec3(0, 0, 1) : Vec3(1, 0, 0), back);
  right = glm::normalize(right);
  return glm::normalize(glm::quat_cast(Mat3(right, glm::cross(back, right), back)));
}

}  // namespace relume
