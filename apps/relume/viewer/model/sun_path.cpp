#include "viewer/model/sun_path.h"

#include <cmath>

#include "core/vec.h"

namespace relume::viewer {

SunPosition sun_position(float hour, int day_of_year, float latitude_rad) {
  constexpr float kTilt_rad = 23.45f * kPi / 180;  // of the Earth's axis
  const float declination = kTilt_rad * std::sin(2 * kPi * static_cast<float>(284 + day_of_year) / 365);
  const float hour_angle = (hour - 12) * (kPi / 12);
  const float sin_l = std::sin(latitude_rad), cos_l = std::cos(latitude_rad);
  const float sin_d = std::sin(declination), cos_d = std::cos(declination);
  // Direction to the sun, in a frame of south, east and zenith.
  const float south = cos_d * std::cos(hour_angle) * sin_l - sin_d * cos_l;
  const float east = -cos_d * std::sin(hour_angle);
  const float up = cos_d * std::cos(hour_angle) * cos_l + sin_d * sin_l;
  return {std::asin(clamp(up, -1, 1)), std::atan2(east, south)};
}

}  // namespace relume::viewer
