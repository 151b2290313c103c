// Position of the sun at a time of day.
#pragma once

namespace relume::viewer {

struct SunPosition {
  float elevation_rad = 0;  ///< negative below the horizon
  float azimuth_rad = 0;    ///< from +Z (south) towards +X (east), in [-π, π]
};

/// Solar elevation and azimuth at true solar time `hour` (0 to 24; 12: highest) on the day of the year (1 to 365) at a
/// geographic latitude, from the spherical triangle of zenith, pole and sun with Cooper's declination ([Cooper69]).
SunPosition sun_position(float hour, int day_of_year, float latitude_rad);

}  // namespace relume::viewer
