// White furnaces: albedo of a BSDF, for tests.
#pragma once

#include <algorithm>
#include <string>

#include "materials/testing/bsdf_charts.h"
#include "testing/histogram.h"
#include "testing/integrate.h"
#include "testing/random.h"

namespace relume::testing {

/// Largest channel of the directional albedo, by quadrature of f cos θ. Includes reflection and refraction without the
/// eta_scale of radiance, so a lossless surface returns 1. Excludes delta lobes.
inline double albedo_by_quadrature(const BsdfCase& c, float cos_o) {
  const Vec3 wo = viewer(cos_o);
  const Bsdf bsdf = c.make(cos_o, true);
  const PeakDirections peaks = peak_directions(c, wo);
  double sum = 0;
  for (const int side : {0, 1}) {
    const DirectionChart chart{make_frame(side == 0 ? peaks.above : peaks.below), peaks.width};
    const auto value = [&](const Vec3& wi) {
      if ((wi.z > 0.0f) != (side == 0)) return 0.0;
      return double(max_component(eval_pdf(bsdf, wo, wi, TransportMode::importance).f) * std::fabs(wi.z));
    };
    // The rim of the hemisphere cuts bins, with an error of 1e-4.
    sum += integrate_square(chart.density(value), 16, 2e-5, 5);
  }
  return sum;
}

struct Mean {
  double value = 0;
  double error = 0;  ///< standard error
};

/// Mean weight of samples of a grey BSDF.
inline Mean albedo_by_sampling(const BsdfCase& c, float cos_o, int samples) {
  const Vec3 wo = viewer(cos_o);
  const Bsdf bsdf = c.make(cos_o, true);
  Random random(41);
  double sum = 0;
  double squares = 0;
  for (int i = 0; i < samples; ++i) {
    const float u_lobe = random.next();
    const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d(), TransportMode::importance);
    const double w = s.valid ? max_component(s.weight) : 0.0;
    sum += w;
    squares += w * w;
  }
  const double mean = sum / samples;
  return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

/// The same for the brightest channel.
inline Mean largest_albedo_by_sampling(const BsdfCase& c, float cos_o, int samples) {
  const Vec3 wo = viewer(cos_o);
  const Bsdf bsdf = c.make(cos_o, true);
  Random random(45);
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  for (int i = 0; i < samples; ++i) {
    const float u_lobe = random.next();
    const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d(), TransportMode::importance);
    if (!s.valid) continue;
    sum += glm::dvec3(s.weight);
    squares += glm::dvec3(s.weight * s.weight);
  }
  Mean largest;
  for (int k = 0; k < 3; ++k) {
    const double mean = sum[k] / samples;
    if (mean > largest.value) largest = {mean, std::sqrt(std::max(0.0, squares[k] / samples - mean * mean) / samples)};
  }
  return largest;
}

/// A material of base colour 1.
inline MaterialCase white(const std::string& name, float metallic, float transmission, bool volume) {
  MaterialCase m{name, {}, volume};
  m.sample.metallic = metallic;
  m.sample.transmission = transmission;
  return m;
}

}  // namespace relume::testing
