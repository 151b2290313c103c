#include "viewer/model/sun_path.h"

#include <gtest/gtest.h>

#include "core/vec.h"

namespace relume::viewer {
namespace {

constexpr int kEquinox = 81;  // where Cooper's declination crosses zero
constexpr int kMidsummer = 172;
constexpr int kMidwinter = 355;
constexpr float kLatitude = 48 * kPi / 180;
constexpr float kTilt = 23.45f * kPi / 180;
constexpr float kTolerance = 2e-3f;  // rad; the solstices are between whole days

TEST(SunPath, RisesInTheEastAndSetsInTheWestAtTheEquinox) {
  const SunPosition morning = sun_position(6, kEquinox, kLatitude);
  EXPECT_NEAR(morning.elevation_rad, 0, kTolerance);
  EXPECT_NEAR(morning.azimuth_rad, kPi / 2, kTolerance);
  const SunPosition evening = sun_position(18, kEquinox, kLatitude);
  EXPECT_NEAR(evening.elevation_rad, 0, kTolerance);
  EXPECT_NEAR(evening.azimuth_rad, -kPi / 2, kTolerance);
}

TEST(SunPath, NoonElevationFollowsFromLatitudeAndTilt) {
  EXPECT_NEAR(sun_position(12, kEquinox, kLatitude).elevation_rad, kPi / 2 - kLatitude, kTolerance);
  EXPECT_NEAR(sun_position(12, kMidsummer, kLatitude).elevation_rad, kPi / 2 - kLatitude + kTilt, kTolerance);
  EXPECT_NEAR(sun_position(12, kMidwinter, kLatitude).elevation_rad, kPi / 2 - kLatitude - kTilt, kTolerance);
  EXPECT_NEAR(sun_position(12, kMidsummer, kLatitude).azimuth_rad, 0, kTolerance) << "south";
}

TEST(SunPath, IsHighestAtNoonAndBelowTheHorizonAtMidnight) {
  for (float hour = 0; hour <= 24; hour += 0.5f)
    EXPECT_LE(sun_position(hour, kMidsummer, kLatitude).elevation_rad,
              sun_position(12, kMidsummer, kLatitude).elevation_rad);
  EXPECT_LT(sun_position(0, kMidsummer, kLatitude).elevation_rad, 0);
}

}  // namespace
}  // namespace relume::viewer
