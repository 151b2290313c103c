// Sheen of cloth: distribution and masking of upright fibres ([Estevez17], KHR_materials_sheen), and its albedo.
#pragma once

#include "core/math.h"
#include "core/view.h"
#include "materials/energy_grid.h"

namespace relume {

/// Lower bound of α; smaller values are raised to it. Such fibres are bright within 1° of the horizon only.
inline constexpr float kMinSheenAlpha = 1e-4f;

namespace sheen {

/// Density of fibre normals ([Estevez17], eq. 2).
RELUME_HD inline float d(float cos_m, float alpha) {
  const float sin2 = relume::max(1.0f - cos_m * cos_m, 0.0f);
  const float inverse = 1.0f / alpha;
  return (2.0f + inverse) * math::pow(sin2, 0.5f * inverse) * (0.5f * kInvPi);
}

/// Λ by the fit of [Estevez17], §3 and table 1.
RELUME_HD inline float lambda(float cos_theta, float alpha) {
  const float t = sqr(1.0f - alpha);
  const float a = lerp(21.5473f, 25.3245f, t);
  const float b = lerp(3.82987f, 3.32435f, t);
  const float c = lerp(0.19823f, 0.16801f, t);
  const float d = lerp(-1.97760f, -1.27393f, t);
  const float e = lerp(-4.32054f, -4.85967f, t);
  const auto fit = [&](float x) { return a / (1.0f + b * math::pow(x, c)) + d * x + e; };
  return cos_theta < 0.5f ? math::exp(fit(cos_theta)) : math::exp(2.0f * fit(0.5f) - fit(1.0f - cos_theta));
}

/// f for white fibres, 1/sr: D G / (4 cos θo cos θi).
RELUME_HD inline float value(float cos_m, float cos_o, float cos_i, float alpha) {
  const float masking = 1.0f + lambda(cos_o, alpha) + lambda(cos_i, alpha);
  return d(cos_m, alpha) / (4.0f * masking * cos_o * cos_i);
}

inline constexpr uint32_t kTableSize = 48;
inline constexpr float kFirstRow = 0.1f;  ///< fourth root of kMinSheenAlpha

/// Table row: linear in the fourth root of α.
RELUME_HD inline float row_from_alpha(float alpha) {
  return (std::sqrt(std::sqrt(alpha)) - kFirstRow) * (1.0f / (1.0f - kFirstRow));
}
RELUME_HD inline float alpha_from_row(float y) { return sqr(sqr(lerp(kFirstRow, 1.0f, y))); }

}  // namespace sheen

/// Directional albedo of white fibres; above 1 for thin ones seen edge-on. Look-ups are within 5e-3 of it. Below α =
/// 0.001 they are within 0.01 for albedos below 1/2, and within 8 % above.
struct SheenEnergyTable {
  View<const float> albedo;  ///< kTableSize² entries over rows and √cos θ; empty: not built

  RELUME_HD float directional(float cos_theta, float alpha) const {
    using sheen::kTableSize;
    const energy_grid::Cell x = energy_grid::cell(safe_sqrt(cos_theta), kTableSize);
    const energy_grid::Cell y = energy_grid::cell(sheen::row_from_alpha(alpha), kTableSize);
    const float* row = &albedo[y.index * kTableSize + x.index];
    const float low = lerp(row[0], row[1], x.fraction);
    const float high = lerp(row[kTableSize], row[kTableSize + 1], x.fraction);
    return lerp(low, high, y.fraction);
  }
};

/// The table, integrated once per process; thread-safe.
SheenEnergyTable sheen_energy_table();

}  // namespace relume
