// The von Mises–Fisher distribution: directions around an axis, p(ω) ∝ exp(κ ω · axis).
#pragma once

#include "core/frame.h"
#include "core/math.h"
#include "sampling/warp.h"

namespace relume {

/// A lobe. Its concentration κ is 0, which is the uniform density, or within kLeastConcentration … kMostConcentration.
struct VonMisesFisher {
  // Below the least, rounding would spoil the inverse of the cumulative distribution. At the most, the lobe is 0.8°
  // wide, and directions of 24 bits still resolve it.
  static constexpr float kLeastConcentration = 1e-2f;
  static constexpr float kMostConcentration = 1e4f;

  Vec3 axis{0, 0, 1};       ///< unit
  float concentration = 0;  ///< κ

  /// pdf_w of sample(): κ / (2π (1 − e^−2κ)) · e^(κ (cos θ − 1)). The cosine minus 1 comes from the length of the
  /// difference, which keeps its precision near the axis.
  RELUME_HD float pdf(const Vec3& w) const {
    if (!(concentration >= kLeastConcentration)) return sphere_pdf();
    const Vec3 apart = w - axis;
    const float peak = concentration / (2.0f * kPi * (1.0f - math::exp(-2.0f * concentration)));
    return peak * math::exp(-0.5f * concentration * glm::dot(apart, apart));
  }

  /// Samples a direction by the inverse of the cumulative distribution of 1 − cos θ.
  RELUME_HD Vec3 sample(const Vec2& u) const {
    if (!(concentration >= kLeastConcentration)) return sphere_from_square(u);
    const float v = 1.0f - u.x;  // in (0, 1]: the logarithm is finite
    const float fall = -math::log(v + (1.0f - v) * math::exp(-2.0f * concentration)) / concentration;
    const float one_minus_cos = clamp(fall, 0.0f, 2.0f);
    const float sine = std::sqrt(one_minus_cos * (2.0f - one_minus_cos));
    const Vec2 around = math::unit_vector(2.0f * kPi * u.y);
    return glm::normalize(make_frame(axis).to_world({sine * around.x, sine * around.y, 1.0f - one_minus_cos}));
  }

  /// Concentration from the mean cosine r in [0, 1): κ = (3r − r³) / (1 − r²), an approximation of the maximum
  /// likelihood. 0 below the least; at most kMostConcentration, also for r = 1.
  RELUME_HD static float concentration_of(float mean_cosine) {
    const float r = clamp(mean_cosine, 0.0f, 0.9999999f);
    const float kappa = r * (3.0f - r * r) / (1.0f - r * r);
    return kappa >= kLeastConcentration ? relume::min(kappa, kMostConcentration) : 0.0f;
  }
};

}  // namespace relume
