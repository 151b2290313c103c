// Directional albedo of anisotropic GGX, over roughness, strength, azimuth and angle.
#pragma once

#include "core/math.h"
#include "core/view.h"
#include "materials/anisotropic_ggx.h"
#include "materials/energy_grid.h"
#include "materials/energy_shares.h"

namespace relume {

namespace anisotropic_grid {

inline constexpr uint32_t kRows = 12;  ///< over √α perpendicular to the tangent
inline constexpr uint32_t kStrengths = 8;
inline constexpr uint32_t kAzimuths = 8;  ///< a quarter turn from the tangent; the other quarters mirror it
inline constexpr uint32_t kColumns = 16;

/// Apparent α for a viewer at azimuth (cos φ, sin φ) from the tangent.
RELUME_HD inline float projected_alpha(float alpha_t, float alpha_b, float cos_phi, float sin_phi) {
  return std::sqrt(sqr(alpha_t * cos_phi) + sqr(alpha_b * sin_phi));
}

/// Table coordinate of the azimuth, from 0 to 1: the mean of φ and of φ in the space of equal widths. It is dense
/// across the tangent, where the albedo changes fastest.
RELUME_HD inline float azimuth_coordinate(float cos_phi, float sin_phi, float stretch) {
  return (math::atan2(sin_phi, cos_phi) + math::atan2(sin_phi, cos_phi * stretch)) * kInvPi;
}

}  // namespace anisotropic_grid

/// View of the tables. For cos θ ≥ 0.03, look-ups are within 0.03 of the albedo; their mean deviation is below 0.01.
struct AnisotropicEnergyTable {
  View<const Vec2> directional;  ///< (total, grazing) by row, strength, azimuth, column; empty: not built
  View<const Vec2> average;      ///< by row, strength: 2 ∫ (…) cos θ d cos θ over all azimuths

  RELUME_HD_NOINLINE EnergyShares directional_shares(const AnisotropicGgx& mf, const Vec3& w) const {
    using namespace anisotropic_grid;
    const Vec3 t = mf.to_tangent(w);
    const float length = std::sqrt(t.x * t.x + t.y * t.y);
    const float cos_phi = length > 0.0f ? std::fabs(t.x) / length : 1.0f;
    const float sin_phi = length > 0.0f ? std::fabs(t.y) / length : 0.0f;
    const float r = std::sqrt(projected_alpha(mf.alpha_t, mf.alpha_b, cos_phi, sin_phi));
    const energy_grid::Cell cells[4] = {
        energy_grid::cell(energy_grid::row_from_r(std::sqrt(mf.alpha_b)), kRows),
        energy_grid::cell(mf.strength, kStrengths),
        energy_grid::cell(azimuth_coordinate(cos_phi, sin_phi, mf.alpha_t / mf.alpha_b), kAzimuths),
        energy_grid::cell(energy_grid::column_from_cosine(std::fabs(t.z), r), kColumns)};
    constexpr uint32_t kSizes[4] = {kRows, kStrengths, kAzimuths, kColumns};
    Vec2 value(0);
    for (uint32_t corner = 0; corner < 16; ++corner) {
      float weight = 1;
      uint32_t index = 0;
      for (uint32_t axis = 0; axis < 4; ++axis) {
        const uint32_t far = corner >> axis & 1u;
        weight *= far ? cells[axis].fraction : 1.0f - cells[axis].fraction;
        index = index * kSizes[axis] + cells[axis].index + far;
      }
      value += directional[index] * weight;
    }
    return {value.x, value.y};
  }

  RELUME_HD_NOINLINE EnergyShares average_shares(const AnisotropicGgx& mf) const {
    using namespace anisotropic_grid;
    const energy_grid::Cell y = energy_grid::cell(energy_grid::row_from_r(std::sqrt(mf.alpha_b)), kRows);
    const energy_grid::Cell x = energy_grid::cell(mf.strength, kStrengths);
    const Vec2* row = &average[y.index * kStrengths + x.index];
    const Vec2 low = row[0] + (row[1] - row[0]) * x.fraction;
    const Vec2 high = row[kStrengths] + (row[kStrengths + 1] - row[kStrengths]) * x.fraction;
    const Vec2 value = low + (high - low) * y.fraction;
    return {value.x, value.y};
  }
};

/// The tables, integrated once per process; thread-safe.
AnisotropicEnergyTable anisotropic_energy_table();

}  // namespace relume
