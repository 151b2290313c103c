// Directional albedo of microfacet surfaces, tabulated over angle and roughness. A second lobe returns the loss of
// single scattering ([Kulla17]). The base below an interface receives the light that the interface does not reflect.
#pragma once

#include <array>
#include <vector>

#include "core/view.h"
#include "materials/anisotropic_energy.h"
#include "materials/energy_grid.h"
#include "materials/energy_shares.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"
#include "materials/sheen_energy.h"

namespace relume {

inline constexpr uint32_t kEnergyTableSize = 64;

/// View of the tables of one microfacet model. Bilinear look-ups are within 1e-3 of the albedo for cos θ ≥ 0.01.
struct EnergyTable {
  View<const Vec2> directional;  ///< kEnergyTableSize² entries (total, grazing)
  View<const Vec2> average;      ///< kEnergyTableSize entries: 2 ∫ (…) cos θ d cos θ

  /// Shares of the albedo; `r` = √α. Exact for smooth surfaces.
  RELUME_HD EnergyShares directional_shares(float cos_theta, float r) const {
    if (r < energy_grid::kMinR) return {1.0f, pow5(saturate(1.0f - cos_theta))};
    const energy_grid::Cell x = energy_grid::cell(energy_grid::column_from_cosine(cos_theta, r), kEnergyTableSize);
    const energy_grid::Cell y = energy_grid::cell(energy_grid::row_from_r(r), kEnergyTableSize);
    const Vec2* row = &directional[y.index * kEnergyTableSize + x.index];
    const Vec2 low = row[0] + (row[1] - row[0]) * x.fraction;
    const Vec2 high = row[kEnergyTableSize] + (row[kEnergyTableSize + 1] - row[kEnergyTableSize]) * x.fraction;
    const Vec2 value = low + (high - low) * y.fraction;
    return {value.x, value.y};
  }

  RELUME_HD EnergyShares average_shares(float r) const {
    if (r < energy_grid::kMinR) return {1.0f, 1.0f / 21.0f};
    const energy_grid::Cell y = energy_grid::cell(energy_grid::row_from_r(r), kEnergyTableSize);
    const Vec2 value = average[y.index] + (average[y.index + 1] - average[y.index]) * y.fraction;
    return {value.x, value.y};
  }
};

struct EnergyTables {
  EnergyTable ggx;
  EnergyTable beckmann;
  AnisotropicEnergyTable anisotropic;  ///< empty unless requested
  SheenEnergyTable sheen;              ///< empty unless requested

  RELUME_HD const EnergyTable& of(MicrofacetModel model) const {
    return model == MicrofacetModel::ggx ? ggx : beckmann;
  }
};

/// The tables, integrated by quadrature once per process; thread-safe.
const EnergyTables& energy_tables();

/// Layers with separate tables.
struct LayerTables {
  bool anisotropic = true;
  bool sheen = true;
};

/// The same with the tables in `needed`; others are empty. Each is integrated on first use.
const EnergyTables& layered_energy_tables(const LayerTables& needed = {});

}  // namespace relume
