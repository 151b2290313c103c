// How much a microfacet surface reflects: directional albedo, tabulated over angle and roughness. What single
// scattering loses is given back by a second lobe ([Kulla17]), and what a coat reflects is missing below it.
#pragma once

#include <array>
#include <vector>

#include "core/view.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"

namespace relume {

/// Single-scattering albedo under Schlick's Fresnel, split as f0·(total − grazing) + f90·grazing.
struct EnergyShares {
  float total = 1;    ///< albedo for F = 1
  float grazing = 0;  ///< the part that (1 − cos)^5 weighs
};

inline constexpr uint32_t kEnergyTableSize = 64;

/// Where the tables have their entries. Rows lie over r = √α from √kMinAlpha to 1, denser at the smooth end. Within a
/// row the albedo falls where cos θ is about α, however small α is, and Schlick's term changes over all of cos θ:
/// columns follow the mean of √cos θ and of a curve that is half way where √cos θ is 1.5 r.
namespace energy_grid {

inline constexpr float kMinR = 0.0316227766f;  ///< √kMinAlpha

RELUME_HD inline float row_from_r(float r) { return safe_sqrt((r - kMinR) * (1.0f / (1.0f - kMinR))); }
RELUME_HD inline float r_from_row(float y) { return kMinR + (1.0f - kMinR) * y * y; }
RELUME_HD inline float column_from_cosine(float cos_theta, float r) {
  const float s = safe_sqrt(cos_theta);
  const float k = 1.5f * r;
  return 0.5f * s * (1.0f + (1.0f + k) / (s + k));
}

}  // namespace energy_grid

/// View of the tables of one microfacet model. Bilinear look-ups are within 1e-3 of the albedo for cos θ ≥ 0.01.
struct EnergyTable {
  View<const Vec2> directional;  ///< kEnergyTableSize² entries (total, grazing)
  View<const Vec2> average;      ///< kEnergyTableSize entries: 2 ∫ (…) cos θ d cos θ

  /// `r` = √α. Exact for smooth surfaces.
  RELUME_HD EnergyShares directional_shares(float cos_theta, float r) const {
    if (r < energy_grid::kMinR) return {1.0f, pow5(saturate(1.0f - cos_theta))};
    const Cell x = cell(energy_grid::column_from_cosine(cos_theta, r));
    const Cell y = cell(energy_grid::row_from_r(r));
    const Vec2* row = &directional[y.index * kEnergyTableSize + x.index];
    const Vec2 low = row[0] + (row[1] - row[0]) * x.fraction;
    const Vec2 high = row[kEnergyTableSize] + (row[kEnergyTableSize + 1] - row[kEnergyTableSize]) * x.fraction;
    const Vec2 value = low + (high - low) * y.fraction;
    return {value.x, value.y};
  }

  RELUME_HD EnergyShares average_shares(float r) const {
    if (r < energy_grid::kMinR) return {1.0f, 1.0f / 21.0f};
    const Cell y = cell(energy_grid::row_from_r(r));
    const Vec2 value = average[y.index] + (average[y.index + 1] - average[y.index]) * y.fraction;
    return {value.x, value.y};
  }

 private:
  struct Cell {
    uint32_t index;
    float fraction;
  };
  RELUME_HD static Cell cell(float x) {
    const float scaled = saturate(x) * static_cast<float>(kEnergyTableSize - 1);
    uint32_t i = static_cast<uint32_t>(scaled);
    if (i > kEnergyTableSize - 2) i = kEnergyTableSize - 2;
    return {i, scaled - static_cast<float>(i)};
  }
};

struct EnergyTables {
  EnergyTable ggx;
  EnergyTable beckmann;

  RELUME_HD const EnergyTable& of(MicrofacetModel model) const {
    return model == MicrofacetModel::ggx ? ggx : beckmann;
  }
};

/// The tables, integrated by quadrature once a process; thread-safe.
const EnergyTables& energy_tables();

}  // namespace relume
