#include "materials/energy_tables.h"

#include <cmath>

#include "core/parallel.h"

namespace relume {
namespace {

constexpr int kPolar = 64;    // Gauss-Legendre points over the random number of the polar angle
constexpr int kAzimuth = 32;  // midpoints over half a turn; symmetry covers the other half

struct Quadrature {
  float u[kPolar];  ///< 1 − random number
  float weight[kPolar];
  float cos_phi[kAzimuth];
  float sin_phi[kAzimuth];
};

/// Gauss-Legendre points on [0, 1] by Newton's method, squared. They are dense at small 1 − u, in the tails of the
/// distributions, where light is lost below the horizon.
Quadrature make_quadrature() {
  Quadrature q;
  for (int i = 0; i < kPolar; ++i) {
    double t = std::cos(M_PI * (i + 0.75) / (kPolar + 0.5));
    double derivative = 1;
    for (int iteration = 0; iteration < 10; ++iteration) {
      double previous = 1;
      double value = t;
      for (int k = 2; k <= kPolar; ++k) {
        const double next = ((2 * k - 1) * t * value - (k - 1) * previous) / k;
        previous = value;
        value = next;
      }
      derivative = kPolar * (t * value - previous) / (t * t - 1);
      t -= value / derivative;
    }
    const double x = 0.5 * (1 + t);
    q.u[i] = static_cast<float>(x * x);
    q.weight[i] = static_cast<float>(2 * x / ((1 - t * t) * derivative * derivative));
  }
  for (int k = 0; k < kAzimuth; ++k) {
    const double phi = M_PI * (k + 0.5) / kAzimuth;
    q.cos_phi[k] = static_cast<float>(std::cos(phi));
    q.sin_phi[k] = static_cast<float>(std::sin(phi));
  }
  return q;
}

/// Microfacet normals for one value of the polar number, (x, ·, z) each, as sampled by Microfacet::sample.
struct Normals {
  float x[kAzimuth];
  float z[kAzimuth];
};

void sample_ggx(const Quadrature& q, float u, float alpha, const Vec3& wo, Normals& m) {
  const Vec3 w = glm::normalize(Vec3(wo.x * alpha, 0.0f, wo.z));
  const float z = u * (1.0f + w.z) - w.z;
  const float r = safe_sqrt(1.0f - z * z);
  const float up = std::fmax(z + w.z, 1e-7f);
  for (int k = 0; k < kAzimuth; ++k) {
    const float x = (r * q.cos_phi[k] + w.x) * alpha;
    const float y = r * q.sin_phi[k] * alpha;
    const float scale = 1.0f / std::sqrt(x * x + y * y + up * up);
    m.x[k] = x * scale;
    m.z[k] = up * scale;
  }
}

void sample_beckmann(const Quadrature& q, float u, float alpha, Normals& m) {
  const float tan2 = -alpha * alpha * std::log(u);
  const float z = 1.0f / std::sqrt(1.0f + tan2);
  const float r = z * std::sqrt(tan2);
  for (int k = 0; k < kAzimuth; ++k) {
    m.x[k] = r * q.cos_phi[k];
    m.z[k] = z;
  }
}

/// Maximum of two numbers. Unlike std::fmax, it compiles to one vector instruction.
float at_least(float x, float low) { return x > low ? x : low; }

/// Branch-free Microfacet::lambda as a function of tan²θ.
float lambda_ggx(float alpha, float tan2) { return 0.5f * (std::sqrt(1.0f + alpha * alpha * tan2) - 1.0f); }
float lambda_beckmann(float alpha, float tan2) {
  const float a = 1.0f / (alpha * std::sqrt(tan2));
  const float value = (1.0f - 1.259f * a + 0.396f * a * a) / (3.535f * a + 2.181f * a * a);
  return a < kBeckmannLambdaEnd ? value : 0.0f;
}

/// Albedo of the reflection lobe for F = 1 and for F = (1 − cos)^5. It is a mean over the random numbers that sample
/// the lobe: of G2 / G1 for GGX, of G2 (wo·m) / (cos θo cos θm) for Beckmann. Each loop runs over the azimuths in
/// independent lanes.
template <MicrofacetModel kModel>
Vec2 integrate(const Quadrature& q, float alpha, float cos_o) {
  constexpr bool kGgx = kModel == MicrofacetModel::ggx;
  const Vec3 wo(safe_sqrt(1.0f - cos_o * cos_o), 0.0f, cos_o);
  const float lambda_o = Microfacet{kModel, alpha}.lambda(wo);
  float total[kAzimuth] = {};
  float grazing[kAzimuth] = {};
  Normals m;
  for (int i = 0; i < kPolar; ++i) {
    if constexpr (kGgx) {
      sample_ggx(q, q.u[i], alpha, wo, m);
    } else {
      sample_beckmann(q, q.u[i], alpha, m);
    }
    for (int k = 0; k < kAzimuth; ++k) {
      const float cos_om = wo.x * m.x[k] + wo.z * m.z[k];
      const float cos_i = 2.0f * cos_om * m.z[k] - wo.z;
      const float up = at_least(cos_i, 1e-6f);
      const float tan2 = at_least(1.0f - up * up, 1e-12f) / (up * up);
      const float lambda_i = kGgx ? lambda_ggx(alpha, tan2) : lambda_beckmann(alpha, tan2);
      const float sampled = kGgx ? 1.0f + lambda_o : cos_om / (wo.z * m.z[k]);
      const float weight = q.weight[i] * sampled / (1.0f + lambda_o + lambda_i);
      const float valid = (cos_om > 0.0f ? 1.0f : 0.0f) * (cos_i > 0.0f ? 1.0f : 0.0f);
      total[k] += weight * valid;
      grazing[k] += weight * valid * pow5(1.0f - cos_om);
    }
  }
  double sum = 0;
  double grazing_sum = 0;
  for (int k = 0; k < kAzimuth; ++k) {
    sum += total[k];
    grazing_sum += grazing[k];
  }
  // Clamped: quadrature and the fit of Λ raise the albedo of nearly smooth surfaces slightly above one.
  return {static_cast<float>(std::fmin(sum / kAzimuth, 1.0)), static_cast<float>(grazing_sum / kAzimuth)};
}

struct TableStorage {
  std::vector<Vec2> directional;
  std::vector<Vec2> average;
  EnergyTable view() const { return {view_of(directional), view_of(average)}; }
};

/// 2 ∫ E(μ) μ dμ of the interpolated row, so the integral matches look-ups.
Vec2 average_of_row(const EnergyTable& table, float r) {
  constexpr int kSteps = 1024;
  double total = 0;
  double grazing = 0;
  for (int i = 0; i < kSteps; ++i) {
    const float s = (static_cast<float>(i) + 0.5f) / kSteps;  // μ = s²: resolves grazing angles
    const EnergyShares shares = table.directional_shares(s * s, r);
    const double weight = 4.0 * s * s * s / kSteps;
    total += (1.0 - shares.total) * weight;  // sums the small difference to avoid rounding
    grazing += shares.grazing * weight;
  }
  return {static_cast<float>(1.0 - total), static_cast<float>(grazing)};
}

template <MicrofacetModel kModel>
TableStorage build() {
  const Quadrature quadrature = make_quadrature();
  constexpr float kScale = 1.0f / (kEnergyTableSize - 1);
  TableStorage storage;
  storage.directional.resize(kEnergyTableSize * kEnergyTableSize);
  storage.average.resize(kEnergyTableSize);
  const EnergyTable table = storage.view();
  parallel_for(kEnergyTableSize, [&](uint32_t row) {
    const float r = energy_grid::r_from_row(static_cast<float>(row) * kScale);
    for (uint32_t column = 0; column < kEnergyTableSize; ++column) {
      const float cos_o = std::fmax(energy_grid::cosine_from_column(static_cast<float>(column) * kScale, r), 1e-5f);
      storage.directional[row * kEnergyTableSize + column] = integrate<kModel>(quadrature, r * r, cos_o);
    }
  });
  for (uint32_t row = 0; row < kEnergyTableSize; ++row) {
    storage.average[row] = average_of_row(table, energy_grid::r_from_row(static_cast<float>(row) * kScale));
  }
  return storage;
}

}  // namespace

const EnergyTables& energy_tables() {
  static const TableStorage ggx = build<MicrofacetModel::ggx>();
  static const TableStorage beckmann = build<MicrofacetModel::beckmann>();
  static const EnergyTables tables{ggx.view(), beckmann.view(), {}, {}};
  return tables;
}

const EnergyTables& layered_energy_tables(const LayerTables& needed) {
  const EnergyTables& plain = energy_tables();
  if (needed.anisotropic && needed.sheen) {
    static const EnergyTables both{plain.ggx, plain.beckmann, anisotropic_energy_table(), sheen_energy_table()};
    return both;
  }
  if (needed.anisotropic) {
    static const EnergyTables anisotropic{plain.ggx, plain.beckmann, anisotropic_energy_table(), {}};
    return anisotropic;
  }
  if (needed.sheen) {
    static const EnergyTables sheen{plain.ggx, plain.beckmann, {}, sheen_energy_table()};
    return sheen;
  }
  return plain;
}

}  // namespace relume
