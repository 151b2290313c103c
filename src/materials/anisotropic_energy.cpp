#include "materials/anisotropic_energy.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "materials/fresnel.h"

namespace relume {
namespace {

using namespace anisotropic_grid;

constexpr int kPolar = 32;      // midpoints over √(1 − u), dense in the tail
constexpr int kAzimuthal = 32;  // midpoints over a full turn

/// Albedo shares (total, grazing) of the lobe seen from `wo`: the mean of G2 / G1 over its random numbers.
Vec2 integrate(const AnisotropicGgx& mf, const Vec3& wo) {
  const float lambda_o = mf.lambda(wo);
  double total = 0;
  double grazing = 0;
  for (int i = 0; i < kPolar; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) / kPolar;
    for (int k = 0; k < kAzimuthal; ++k) {
      const Vec3 m = mf.sample(wo, {(static_cast<float>(k) + 0.5f) / kAzimuthal, 1.0f - t * t});
      const float cos_om = glm::dot(wo, m);
      const Vec3 wi = reflect(wo, m);
      if (cos_om <= 0.0f || wi.z <= 0.0f) continue;
      const float weight = 2.0f * t * (1.0f + lambda_o) / (1.0f + lambda_o + mf.lambda(wi));
      total += weight;
      grazing += weight * pow5(saturate(1.0f - cos_om));
    }
  }
  constexpr double kCount = double{kPolar} * kAzimuthal;
  return {static_cast<float>(std::fmin(total / kCount, 1.0)), static_cast<float>(grazing / kCount)};
}

/// Inverse of azimuth_coordinate by bisection, radians.
float azimuth_at(float place, float stretch) {
  float low = 0;
  float high = 0.5f * kPi;
  for (int i = 0; i < 30; ++i) {
    const float middle = 0.5f * (low + high);
    (azimuth_coordinate(std::cos(middle), std::sin(middle), stretch) < place ? low : high) = middle;
  }
  return 0.5f * (low + high);
}

AnisotropicGgx distribution(uint32_t row, uint32_t strength) {
  const float alpha_b = sqr(energy_grid::r_from_row(static_cast<float>(row) / (kRows - 1)));
  const float s = static_cast<float>(strength) / (kStrengths - 1);
  return {lerp(alpha_b, 1.0f, s * s), alpha_b, s, Vec2(1, 0)};
}

struct Storage {
  std::vector<Vec2> directional = std::vector<Vec2>(kRows * kStrengths * kAzimuths * kColumns);
  std::vector<Vec2> average = std::vector<Vec2>(kRows * kStrengths);
  AnisotropicEnergyTable view() const { return {view_of(directional), view_of(average)}; }
};

void fill(const AnisotropicGgx& mf, Vec2* entries) {
  for (uint32_t a = 0; a < kAzimuths; ++a) {
    const float phi = azimuth_at(static_cast<float>(a) / (kAzimuths - 1), mf.alpha_t / mf.alpha_b);
    const float r = std::sqrt(projected_alpha(mf.alpha_t, mf.alpha_b, std::cos(phi), std::sin(phi)));
    for (uint32_t c = 0; c < kColumns; ++c) {
      const float place = static_cast<float>(c) / (kColumns - 1);
      const float cos_o = std::fmax(energy_grid::cosine_from_column(place, r), 1e-5f);
      const float sin_o = safe_sqrt(1.0f - cos_o * cos_o);
      entries[a * kColumns + c] = integrate(mf, {sin_o * std::cos(phi), sin_o * std::sin(phi), cos_o});
    }
  }
}

/// 2 ∫ E(μ) μ dμ of the interpolated table, averaged over azimuths.
Vec2 average_of(const AnisotropicEnergyTable& table, const AnisotropicGgx& mf) {
  constexpr int kSteps = 64;
  constexpr int kTurns = 32;
  double total = 0;
  double grazing = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float s = (static_cast<float>(i) + 0.5f) / kSteps;  // μ = s²: resolves grazing angles
    const float sin_theta = safe_sqrt(1.0f - s * s * s * s);
    for (int k = 0; k < kTurns; ++k) {
      const float phi = 0.5f * kPi * (static_cast<float>(k) + 0.5f) / kTurns;
      const EnergyShares e =
          table.directional_shares(mf, {sin_theta * std::cos(phi), sin_theta * std::sin(phi), s * s});
      const double weight = 4.0 * s * s * s / (double{kSteps} * kTurns);
      total += (1.0 - e.total) * weight;
      grazing += e.grazing * weight;
    }
  }
  return {static_cast<float>(1.0 - total), static_cast<float>(grazing)};
}

Storage build() {
  Storage storage;
  const AnisotropicEnergyTable table = storage.view();
  parallel_for(kRows * kStrengths, [&](uint32_t i) {
    fill(distribution(i / kStrengths, i % kStrengths), &storage.directional[i * kAzimuths * kColumns]);
  });
  parallel_for(kRows * kStrengths, [&](uint32_t i) {
    storage.average[i] = average_of(table, distribution(i / kStrengths, i % kStrengths));
  });
  return storage;
}

}  // namespace

AnisotropicEnergyTable anisotropic_energy_table() {
  static const Storage storage = build();
  return storage.view();
}

}  // namespace relume
