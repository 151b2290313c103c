// How much a microfacet surface reflects: directional albedo, tabulated over angle and roughness. What single scattering
// loses is given back by a second lobe ([Kulla17]), and what a coat reflects is missing below it.
#pragma once

#include <array>
#include <vector>

#include "core/view.h"
#include "materials/microfacet.h"

namespace relume {

/// Single-scattering albedo under Schlick's Fresnel, split as f0·(total − grazing) + f90·grazing.
struct EnergyShares {
  float total = 1;    ///< albedo for F = 1
  float grazing = 0;  ///< the part that (1 − cos)^5 weighs
};

inline constexpr uint32_t kEnergyTableSize = 32;

/// View of the tables of one microfacet model. Rows over r = √α in [0, 1], columns over √cos θ in [0, 1].
struct EnergyTable {
  View<const Vec2> directional;  ///< kEnergyTableSize² entries (total, grazing)
  View<const Vec2> average;      ///< kEnergyTableSize entries: 2 ∫ (…) cos θ d cos θ

  RELUME_HD EnergyShares directional_shares(float cos_theta, float r) const {
    const Cell x = cell(std::sqrt(saturate(cos_theta)));
    const Cell y = cell(r);
    const Vec2* row = &directional[y.index * kEnergyTableSize + x.index];
    const Vec2 low = row[0] + (row[1] - row[0]) * x.fraction;
    const Vec2 high = row[kEnergyTableSize] + (row[kEnergyTableSize + 1] - row[kEnergyTableSize]) * x.fraction;
    const Vec2 value = low + (high - low) * y.fraction;
    return {value.x, value.y};
  }

  RELUME_HD EnergyShares average_shares(float r) const {
    const Cell y = cell(r);
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

/// The tables, integrated by quadrature once a process (some 30 ms); thread-safe.
const EnergyTables& energy_tables();

}  // namespace relume
