#include "scene/sun_sky.h"

#include <algorithm>

#include "core/parallel.h"

namespace relume {
namespace {

/// Five-parameter sky of Perez et al. for one channel ([Preetham99], eq. 3 and appendix A.2).
struct Perez {
  float a, b, c, d, e;
  float operator()(float cos_theta, float gamma) const {
    const float cos_gamma = std::cos(gamma);
    return (1.0f + a * std::exp(b / std::max(cos_theta, 0.01f))) *
           (1.0f + c * std::exp(d * gamma) + e * cos_gamma * cos_gamma);
  }
};

Perez luminance_distribution(float t) {
  return {0.1787f * t - 1.4630f, -0.3554f * t + 0.4275f, -0.0227f * t + 5.3251f, 0.1206f * t - 2.5771f,
          -0.0670f * t + 0.3703f};
}
Perez x_distribution(float t) {
  return {-0.0193f * t - 0.2592f, -0.0665f * t + 0.0008f, -0.0004f * t + 0.2125f, -0.0641f * t - 0.8989f,
          -0.0033f * t + 0.0452f};
}
Perez y_distribution(float t) {
  return {-0.0167f * t - 0.2608f, -0.0950f * t + 0.0092f, -0.0079f * t + 0.2102f, -0.0441f * t - 1.6537f,
          -0.0109f * t + 0.0529f};
}

/// Chromaticity at the zenith: a cubic in the sun's zenith angle with coefficients quadratic in turbidity.
float zenith_chromaticity(const float m[3][4], float t, float theta) {
  const auto cubic = [&](const float* k) { return ((k[0] * theta + k[1]) * theta + k[2]) * theta + k[3]; };
  return t * t * cubic(m[0]) + t * cubic(m[1]) + cubic(m[2]);
}

constexpr float kZenithX[3][4] = {{0.00166f, -0.00375f, 0.00209f, 0.0f},
                                  {-0.02903f, 0.06377f, -0.03202f, 0.00394f},
                                  {0.11693f, -0.21196f, 0.06052f, 0.25886f}};
constexpr float kZenithY[3][4] = {{0.00275f, -0.00610f, 0.00317f, 0.0f},
                                  {-0.04214f, 0.08970f, -0.04153f, 0.00516f},
                                  {0.15346f, -0.26756f, 0.06670f, 0.26688f}};

/// Luminance at the zenith, kcd/m².
float zenith_luminance(float t, float theta) {
  const float chi = (4.0f / 9.0f - t / 120.0f) * (kPi - 2.0f * theta);
  return std::max(0.0f, (4.0453f * t - 4.9710f) * std::tan(chi) - 0.2155f * t + 2.4192f);
}

/// Converts CIE xyY to linear Rec. 709.
Rgb rgb_from_xyy(float x, float y, float luminance_y) {
  const float big_x = x / y * luminance_y;
  const float big_z = (1.0f - x - y) / y * luminance_y;
  const Rgb rgb(3.2404542f * big_x - 1.5371385f * luminance_y - 0.4985314f * big_z,
                -0.9692660f * big_x + 1.8760108f * luminance_y + 0.0415560f * big_z,
                0.0556434f * big_x - 0.2040259f * luminance_y + 1.0572252f * big_z);
  return glm::max(rgb, Rgb(0));
}

/// Direct sunlight on a facing plane, klx: 128 klx outside the atmosphere, attenuated by Rayleigh scattering and
/// aerosols at the wavelengths of the three primaries ([Preetham99], appendix A.1). Omits ozone and water vapour.
Rgb sun_irradiance(const SunSky& p) {
  if (p.sun_elevation_rad <= 0.0f) return Rgb(0);
  const float zenith_deg = (kPi / 2 - p.sun_elevation_rad) * 180.0f / kPi;
  const float mass = 1.0f / (std::sin(p.sun_elevation_rad) + 0.15f * std::pow(93.885f - zenith_deg, -1.253f));
  const float beta = 0.04608f * p.turbidity - 0.04586f;
  const float wavelengths_um[3] = {0.61f, 0.55f, 0.465f};
  Rgb transmitted;
  for (int c = 0; c < 3; ++c) {
    const float l = wavelengths_um[c];
    transmitted[c] = std::exp(-mass * (0.008735f * std::pow(l, -4.08f) + beta * std::pow(l, -1.3f)));
  }
  constexpr float kExtraterrestrialKlx = 128.0f;
  return transmitted * (kExtraterrestrialKlx * p.sun_scale);
}

}  // namespace

Vec3 sun_direction(const SunSky& p) {
  const float c = std::cos(p.sun_elevation_rad);
  return {c * std::sin(p.sun_azimuth_rad), std::sin(p.sun_elevation_rad), c * std::cos(p.sun_azimuth_rad)};
}

Rgb sky_radiance(const SunSky& p, const Vec3& w) {
  const float t = p.turbidity;
  const float theta_sun = std::clamp(kPi / 2 - p.sun_elevation_rad, 0.0f, kPi / 2);
  const float gamma = std::acos(clamp(glm::dot(w, sun_direction(p)), -1.0f, 1.0f));
  const auto relative = [&](const Perez& f) { return f(w.y, gamma) / f(1.0f, theta_sun); };
  const float y_luminance = zenith_luminance(t, theta_sun) * relative(luminance_distribution(t));
  const float x = zenith_chromaticity(kZenithX, t, theta_sun) * relative(x_distribution(t));
  const float y = zenith_chromaticity(kZenithY, t, theta_sun) * relative(y_distribution(t));
  return rgb_from_xyy(x, y, y_luminance) * p.sky_scale;
}

SunSkyModel make_sun_sky(const SunSky& p) {
  SunSkyModel model;
  model.width = 512;
  model.height = 256;
  model.sky.resize(static_cast<size_t>(model.width) * static_cast<size_t>(model.height));
  model.sun.to_light = sun_direction(p);
  model.sun.irradiance = sun_irradiance(p);
  model.sun.one_minus_cos = 2.0f * sqr(std::sin(0.25f * p.sun_angular_diameter_rad));

  const auto row_of = [&](int y) { return model.sky.begin() + static_cast<ptrdiff_t>(y) * model.width; };
  const int horizon = model.height / 2;
  std::vector<Rgb> row_irradiance(static_cast<size_t>(horizon), Rgb(0));
  parallel_for(horizon, [&](int y) {
    const float theta = (static_cast<float>(y) + 0.5f) / static_cast<float>(model.height) * kPi;
    const float solid_angle = 2.0f * kPi * kPi / static_cast<float>(model.width * model.height) * std::sin(theta);
    for (int x = 0; x < model.width; ++x) {
      const float phi = ((static_cast<float>(x) + 0.5f) / static_cast<float>(model.width) - 0.5f) * 2.0f * kPi;
      const Vec3 w(std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi));
      const Rgb radiance = sky_radiance(p, w);
      row_of(y)[x] = radiance;
      row_irradiance[static_cast<size_t>(y)] += radiance * (solid_angle * w.y);
    }
  });
  Rgb ground = model.sun.irradiance * std::max(0.0f, model.sun.to_light.y);
  for (const Rgb& e : row_irradiance) ground += e;
  ground *= p.ground_albedo * kInvPi;
  std::fill(row_of(horizon), model.sky.end(), ground);
  return model;
}

}  // namespace relume
