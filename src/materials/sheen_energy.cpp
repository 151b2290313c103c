#include "materials/sheen_energy.h"

#include <cmath>
#include <vector>

#include "core/parallel.h"

namespace relume {
namespace {

/// ∫ f cos θi over the hemisphere, by midpoints that are dense at the horizon.
float integrate(float cos_o, float alpha) {
  constexpr int kPolar = 96;
  constexpr int kAzimuth = 48;  // over half a turn; symmetry covers the other half
  const float sin_o = safe_sqrt(1.0f - cos_o * cos_o);
  double sum = 0;
  for (int i = 0; i < kPolar; ++i) {
    const float s = (static_cast<float>(i) + 0.5f) / kPolar;
    const float cos_i = s * s;
    const float sin_i = safe_sqrt(1.0f - cos_i * cos_i);
    const float weight = 4.0f * s * kPi / (kPolar * kAzimuth) * cos_i;
    const float masking = 1.0f + sheen::lambda(cos_o, alpha) + sheen::lambda(cos_i, alpha);
    for (int k = 0; k < kAzimuth; ++k) {
      const float phi = kPi * (static_cast<float>(k) + 0.5f) / kAzimuth;
      const Vec3 m = glm::normalize(Vec3(sin_o + sin_i * std::cos(phi), sin_i * std::sin(phi), cos_o + cos_i));
      sum += sheen::d(m.z, alpha) / (4.0f * masking * cos_o * cos_i) * weight;
    }
  }
  return static_cast<float>(sum);
}

std::vector<float> build() {
  using sheen::kTableSize;
  std::vector<float> albedo(kTableSize * kTableSize);
  parallel_for(kTableSize, [&](uint32_t row) {
    const float alpha = sheen::alpha_from_row(static_cast<float>(row) / (kTableSize - 1));
    for (uint32_t column = 0; column < kTableSize; ++column) {
      const float s = std::fmax(static_cast<float>(column) / (kTableSize - 1), 1e-2f);
      albedo[row * kTableSize + column] = integrate(s * s, alpha);
    }
  });
  return albedo;
}

}  // namespace

SheenEnergyTable sheen_energy_table() {
  static const std::vector<float> albedo = build();
  return {view_of(albedo)};
}

}  // namespace relume
