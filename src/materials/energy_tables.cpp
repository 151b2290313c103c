#include "materials/energy_tables.h"

#include <tbb/parallel_for.h>

#include "materials/fresnel.h"

namespace relume {
namespace {

constexpr int kQuadraturePoints = 48;  // a dimension; doubling it moves no entry by more than 1e-4

struct TableStorage {
  std::vector<Vec2> directional;
  std::vector<Vec2> average;
  EnergyTable view() const { return {view_of(directional), view_of(average)}; }
};

/// Albedo of the reflection lobe for F = 1 and for F = (1 − cos)^5, by the midpoint rule over the random numbers that
/// sample the lobe.
Vec2 integrate(const Microfacet& microfacet, float cos_o) {
  const Vec3 wo(safe_sqrt(1.0f - cos_o * cos_o), 0.0f, cos_o);
  double total = 0;
  double grazing = 0;
  for (int i = 0; i < kQuadraturePoints; ++i) {
    for (int j = 0; j < kQuadraturePoints; ++j) {
      const Vec2 u((static_cast<float>(i) + 0.5f) / kQuadraturePoints, (static_cast<float>(j) + 0.5f) / kQuadraturePoints);
      const Vec3 m = microfacet.sample(wo, u);
      const float cos_om = glm::dot(wo, m);
      const Vec3 wi = reflect(wo, m);
      if (cos_om <= 0.0f || wi.z <= 0.0f) continue;
      const float weight = microfacet.d(m) * microfacet.g2(wo, wi) * cos_om / (wo.z * microfacet.pdf(wo, m));
      total += weight;
      grazing += weight * pow5(1.0f - cos_om);
    }
  }
  constexpr double kCount = kQuadraturePoints * kQuadraturePoints;
  return {static_cast<float>(total / kCount), static_cast<float>(grazing / kCount)};
}

Vec2 entry(MicrofacetModel model, uint32_t row, uint32_t column) {
  const float r = static_cast<float>(row) / (kEnergyTableSize - 1);
  const float cos_o = sqr(static_cast<float>(column) / (kEnergyTableSize - 1));
  const Microfacet microfacet{model, r * r};
  if (microfacet.smooth()) return {1.0f, pow5(1.0f - cos_o)};
  return integrate(microfacet, std::fmax(cos_o, 1e-4f));
}

/// 2 ∫ E(μ) μ dμ of the interpolated row, so that what the look-up returns is what is integrated.
Vec2 average_of_row(const EnergyTable& table, float r) {
  constexpr int kSteps = 2048;
  double total = 0;
  double grazing = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float mu = (static_cast<float>(i) + 0.5f) / kSteps;
    const EnergyShares shares = table.directional_shares(mu, r);
    total += 2.0 * shares.total * mu / kSteps;
    grazing += 2.0 * shares.grazing * mu / kSteps;
  }
  return {static_cast<float>(total), static_cast<float>(grazing)};
}

TableStorage build(MicrofacetModel model) {
  TableStorage storage;
  storage.directional.resize(kEnergyTableSize * kEnergyTableSize);
  tbb::parallel_for(uint32_t{0}, kEnergyTableSize, [&](uint32_t row) {
    for (uint32_t column = 0; column < kEnergyTableSize; ++column) {
      storage.directional[row * kEnergyTableSize + column] = entry(model, row, column);
    }
  });
  const EnergyTable table = storage.view();
  storage.average.resize(kEnergyTableSize);
  for (uint32_t row = 0; row < kEnergyTableSize; ++row) {
    storage.average[row] = average_of_row(table, static_cast<float>(row) / (kEnergyTableSize - 1));
  }
  return storage;
}

}  // namespace

const EnergyTables& energy_tables() {
  static const TableStorage ggx = build(MicrofacetModel::ggx);
  static const TableStorage beckmann = build(MicrofacetModel::beckmann);
  static const EnergyTables tables{ggx.view(), beckmann.view()};
  return tables;
}

}  // namespace relume
