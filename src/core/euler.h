// Rotations as Euler angles.
#pragma once

#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "core/vec.h"

namespace relume {

/// Angles in degrees about X, then Y, then Z (fixed axes) of the rotation `q`; glm::quat(radians) inverts the map. At
/// ±90° about Y, X and Z turn about the same axis, and the angle about Z is 0.
inline Vec3 euler_degrees(const glm::quat& q) {
  const glm::dmat3 m = glm::mat3_cast(glm::normalize(glm::dquat(q)));
  constexpr double kLocked = 1e-6;  // smallest cosine that a float quaternion resolves
  const double cos_y = std::hypot(m[0][0], m[0][1]);
  const bool locked = cos_y < kLocked;
  const double x = locked ? std::atan2(-m[2][1], m[1][1]) : std::atan2(m[1][2], m[2][2]);
  const double z = locked ? 0.0 : std::atan2(m[0][1], m[0][0]);
  return glm::degrees(glm::dvec3(x, std::atan2(-m[0][2], cos_y), z));
}

}  // namespace relume
