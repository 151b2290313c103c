// Expected properties of daylight; the model is [Preetham99].
#include "scene/sun_sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace relume {
namespace {

SunSky sky_with(float elevation, float turbidity) {
  SunSky s;
  s.sun_elevation_rad = elevation;
  s.turbidity = turbidity;
  return s;
}

TEST(SunSky, SunHasTheGivenPosition) {
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
  // A clear zenith has several kcd/m²; the sun has 10 … 128 klx on a facing plane.
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

TEST(SunSky, GroundReflectsItsIrradiance) {
  SunSky s = sky_with(0.7f, 3);
  s.ground_albedo = Rgb(0.5f, 0.25f, 0.1f);
  const SunSkyModel model = make_sun_sky(s);
  // Irradiance of a horizontal plane from the baked sky and the sun.
  glm::dvec3 e = glm::dvec3(model.sun.irradiance) * double(model.sun.to_light.y);
  for (int y = 0; y < model.height / 2; ++y) {
    const double theta = (y + 0.5) / model.height * M_PI;
    for (int x = 0; x < model.width; ++x) {
      e += glm::dvec3(model.sky[static_cast<size_t>(int64_t{y} * model.width + x)]) *
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

/// Independent [Preetham99] in double precision, with the tables as printed in its appendix A.2: one row per parameter
/// A to E, with slope and intercept over turbidity.
using Table = double[5][2];
constexpr Table kLuminance = {
    {0.1787, -1.4630}, {-0.3554, 0.4275}, {-0.0227, 5.3251}, {0.1206, -2.5771}, {-0.0670, 0.3703}};
constexpr Table kX = {{-0.0193, -0.2592}, {-0.0665, 0.0008}, {-0.0004, 0.2125}, {-0.0641, -0.8989}, {-0.0033, 0.0452}};
constexpr Table kY = {{-0.0167, -0.2608}, {-0.0950, 0.0092}, {-0.0079, 0.2102}, {-0.0441, -1.6537}, {-0.0109, 0.0529}};

/// F(θ, γ) / F(0, θ_s), equations 3 and 4.
double relative(const Table& table, double turbidity, double theta, double gamma, double theta_sun) {
  double p[5];
  for (int i = 0; i < 5; ++i) p[i] = table[i][0] * turbidity + table[i][1];
  const auto perez = [&](double t, double g) {
    return (1 + p[0] * std::exp(p[1] / std::cos(t))) *
           (1 + p[2] * std::exp(p[3] * g) + p[4] * std::pow(std::cos(g), 2));
  };
  return perez(theta, gamma) / perez(0, theta_sun);
}

/// Chromaticity at the zenith: (T², T, 1) · matrix · (θ³, θ², θ, 1).
double zenith(const double matrix[3][4], double turbidity, double theta_sun) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 4; ++k) sum += std::pow(turbidity, 2 - i) * matrix[i][k] * std::pow(theta_sun, 3 - k);
  }
  return sum;
}

/// Linear Rec. 709 of a colour, from its primaries and the white point D65.
glm::dvec3 rgb_of(double x, double y, double luminance) {
  const auto xyz = [](double cx, double cy) { return glm::dvec3(cx / cy, 1, (1 - cx - cy) / cy); };
  const glm::dmat3 primaries(xyz(0.64, 0.33), xyz(0.30, 0.60), xyz(0.15, 0.06));
  const glm::dvec3 scale = glm::inverse(primaries) * glm::dvec3(0.95047, 1, 1.08883);
  return glm::max((glm::inverse(primaries) * (xyz(x, y) * luminance)) / scale, glm::dvec3(0));
}

glm::dvec3 expected_sky(double turbidity, double theta_sun, double theta, double gamma) {
  constexpr double kZenithX[3][4] = {
      {0.00166, -0.00375, 0.00209, 0}, {-0.02903, 0.06377, -0.03202, 0.00394}, {0.11693, -0.21196, 0.06052, 0.25886}};
  constexpr double kZenithY[3][4] = {
      {0.00275, -0.00610, 0.00317, 0}, {-0.04214, 0.08970, -0.04153, 0.00516}, {0.15346, -0.26756, 0.06670, 0.26688}};
  const double chi = (4.0 / 9 - turbidity / 120) * (M_PI - 2 * theta_sun);
  const double luminance = (4.0453 * turbidity - 4.9710) * std::tan(chi) - 0.2155 * turbidity + 2.4192;
  const auto towards = [&](const Table& table) { return relative(table, turbidity, theta, gamma, theta_sun); };
  return rgb_of(zenith(kZenithX, turbidity, theta_sun) * towards(kX),
                zenith(kZenithY, turbidity, theta_sun) * towards(kY), luminance * towards(kLuminance));
}

TEST(SunSky, SkyMatchesThePaper) {
  for (const float turbidity : {2.0f, 4.0f, 8.0f}) {
    for (const float elevation : {0.15f, 0.6f, 1.2f}) {
      SunSky s = sky_with(elevation, turbidity);
      s.sun_azimuth_rad = 0.4f;
      const glm::dvec3 sun(sun_direction(s));
      for (const Vec3& towards :
           {Vec3(0, 1, 0), Vec3(sun_direction(s)), Vec3(1, 0.1f, 0.3f), Vec3(-1, 0.7f, -2), Vec3(0.2f, 1, 0.9f)}) {
        const Vec3 w = glm::normalize(towards);
        const glm::dvec3 d(w);
        const glm::dvec3 expected =
            expected_sky(static_cast<double>(turbidity), M_PI / 2 - static_cast<double>(elevation), std::acos(d.y),
                         std::acos(std::min(1.0, glm::dot(d, sun))));
        const Rgb found = sky_radiance(s, w);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(found[c], expected[c], 1e-4 * expected[c])
              << "turbidity " << turbidity << ", elevation " << elevation << ", towards y = " << w.y << ", channel "
              << c;
        }
      }
    }
  }
}

/// Appendix A.1 without ozone, mixed gases and water vapour, applied to 128 klx.
TEST(SunSky, SunMatchesThePaper) {
  for (const float turbidity : {2.0f, 4.0f, 8.0f}) {
    for (const float elevation : {0.15f, 0.6f, 1.2f}) {
      const Rgb found = make_sun_sky(sky_with(elevation, turbidity)).sun.irradiance;
      const double theta = M_PI / 2 - static_cast<double>(elevation);
      const double mass = 1 / (std::cos(theta) + 0.15 * std::pow(93.885 - theta * 180 / M_PI, -1.253));
      const double beta = 0.04608 * static_cast<double>(turbidity) - 0.04586;
      const double wavelengths_um[] = {0.61, 0.55, 0.465};
      for (int c = 0; c < 3; ++c) {
        const double rayleigh = std::exp(-0.008735 * mass * std::pow(wavelengths_um[c], -4.08));
        const double aerosols = std::exp(-beta * mass * std::pow(wavelengths_um[c], -1.3));
        const double expected = 128 * rayleigh * aerosols;
        EXPECT_NEAR(found[c], expected, 1e-4 * expected) << "turbidity " << turbidity << ", elevation " << elevation;
      }
    }
  }
}

}  // namespace
}  // namespace relume
