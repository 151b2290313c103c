// What daylight must be like; the model itself is [Preetham99].
#include "scene/sun_sky.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

SunSky sky_with(float elevation, float turbidity) {
  SunSky s;
  s.sun_elevation_rad = elevation;
  s.turbidity = turbidity;
  return s;
}

TEST(SunSky, SunStandsWhereItIsToldTo) {
  SunSky s = sky_with(0.5f, 3);
  EXPECT_NEAR(sun_direction(s).y, std::sin(0.5f), 1e-6f);
  EXPECT_NEAR(sun_direction(s).z, std::cos(0.5f), 1e-6f);  // azimuth 0 is +Z
  s.sun_azimuth_rad = kPi / 2;
  EXPECT_NEAR(sun_direction(s).x, std::cos(0.5f), 1e-6f);
}

TEST(SunSky, SkyIsBrightestTowardsTheSun) {
  for (const float elevation : {0.2f, 0.7f, 1.2f}) {
    const SunSky s = sky_with(elevation, 3);
    const Vec3 sun = sun_direction(s);
    const Vec3 opposite(-sun.x, sun.y, -sun.z);
    EXPECT_GT(luminance(sky_radiance(s, sun)), luminance(sky_radiance(s, opposite)));
    EXPECT_GT(luminance(sky_radiance(s, sun)), luminance(sky_radiance(s, Vec3(0, 1, 0))));
  }
}

TEST(SunSky, ClearZenithIsBlue) {
  const Rgb zenith = sky_radiance(sky_with(0.5f, 2.5f), Vec3(0, 1, 0));
  EXPECT_GT(zenith.b, 1.5f * zenith.r);
  EXPECT_GT(zenith.b, zenith.g);
}

TEST(SunSky, LuminanceIsInTheRangeOfDaylight) {
  // A clear zenith has some kcd/m²; the sun some 10 … 128 klx on a facing plane.
  const Rgb zenith = sky_radiance(sky_with(0.8f, 3), Vec3(0, 1, 0));
  EXPECT_GT(luminance(zenith), 1.0f);
  EXPECT_LT(luminance(zenith), 20.0f);
  const float sun = luminance(make_sun_sky(sky_with(0.8f, 3)).sun.irradiance);
  EXPECT_GT(sun, 50.0f);
  EXPECT_LT(sun, 128.0f);
}

TEST(SunSky, SunFadesAndReddensTowardsTheHorizonAndInHaze) {
  float previous = 1e9f;
  float previous_ratio = 0;
  for (const float elevation : {1.5f, 1.0f, 0.5f, 0.2f, 0.05f}) {
    const Rgb e = make_sun_sky(sky_with(elevation, 3)).sun.irradiance;
    EXPECT_LT(luminance(e), previous);
    EXPECT_GT(e.r / e.b, previous_ratio);
    previous = luminance(e);
    previous_ratio = e.r / e.b;
  }
  EXPECT_LT(luminance(make_sun_sky(sky_with(0.8f, 8)).sun.irradiance),
            luminance(make_sun_sky(sky_with(0.8f, 2)).sun.irradiance));
  EXPECT_TRUE(is_black(make_sun_sky(sky_with(-0.1f, 3)).sun.irradiance));
}

TEST(SunSky, GroundReflectsWhatFallsOnIt) {
  SunSky s = sky_with(0.7f, 3);
  s.ground_albedo = Rgb(0.5f, 0.25f, 0.1f);
  const SunSkyModel model = make_sun_sky(s);
  // Irradiance of the horizontal by the baked sky and the sun.
  glm::dvec3 e = glm::dvec3(model.sun.irradiance) * double(model.sun.to_light.y);
  for (int y = 0; y < model.height / 2; ++y) {
    const double theta = (y + 0.5) / model.height * M_PI;
    for (int x = 0; x < model.width; ++x) {
      e += glm::dvec3(model.sky[static_cast<size_t>(y * model.width + x)]) *
           (std::cos(theta) * std::sin(theta) * 2 * M_PI * M_PI / (model.width * model.height));
    }
  }
  const Rgb ground = model.sky.back();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(ground[c], s.ground_albedo[c] * e[c] / M_PI, 1e-3 * ground[c]);
}

TEST(SunSky, ScalesAndStaysFinite) {
  for (const float elevation : {-1.0f, 0.0f, 0.001f, 1.57f}) {
    for (const float turbidity : {1.7f, 5.0f, 10.0f}) {
      const SunSkyModel model = make_sun_sky(sky_with(elevation, turbidity));
      for (const Rgb& texel : model.sky) ASSERT_TRUE(is_finite(texel) && min_component(texel) >= 0.0f);
    }
  }
  SunSky doubled = sky_with(0.7f, 3);
  doubled.sky_scale = 2;
  doubled.sun_scale = 3;
  const SunSkyModel a = make_sun_sky(sky_with(0.7f, 3));
  const SunSkyModel b = make_sun_sky(doubled);
  EXPECT_NEAR(b.sky[1000].g / a.sky[1000].g, 2.0f, 1e-5f);
  EXPECT_NEAR(b.sun.irradiance.g / a.sun.irradiance.g, 3.0f, 1e-5f);
}

}  // namespace
}  // namespace relume
