#include "materials/sheen_energy.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

/// ∫ f cos over the hemisphere, at points other than those of the table.
double albedo(float cos_o, float alpha) {
  constexpr int kPolar = 400;
  constexpr int kAzimuth = 200;
  const double sin_o = std::sqrt(1.0 - double{cos_o} * cos_o);
  double sum = 0;
  for (int i = 0; i < kPolar; ++i) {
    const double s = (i + 0.5) / kPolar;
    const double cos_i = s * s * s;
    const double sin_i = std::sqrt(1.0 - cos_i * cos_i);
    for (int k = 0; k < kAzimuth; ++k) {
      const double phi = M_PI * (k + 0.5) / kAzimuth;
      const double x = sin_o + sin_i * std::cos(phi);
      const double y = sin_i * std::sin(phi);
      const double z = cos_o + cos_i;
      const double cos_m = z / std::sqrt(x * x + y * y + z * z);
      sum += double{sheen::value(static_cast<float>(cos_m), cos_o, static_cast<float>(cos_i), alpha)} * cos_i * 6 * s *
             s * M_PI / (double{kPolar} * kAzimuth);
    }
  }
  return sum;
}

/// Reference: [Estevez17], eq. 2, §3 and table 1, evaluated separately in double precision.
TEST(SheenEnergy, ValuesAreThoseOfThePaper) {
  struct Case {
    float alpha, cos_o, cos_i, cos_m;
    double value;
  };
  for (const Case& c : {Case{0.1f, 0.3f, 0.8f, 0.7f, 0.0127142249}, Case{0.1f, 0.05f, 0.2f, 0.4f, 0.5881532863},
                        Case{0.5f, 0.3f, 0.8f, 0.7f, 0.1027801185}, Case{0.5f, 0.9f, 0.6f, 0.95f, 0.0161235256},
                        Case{1.0f, 0.05f, 0.2f, 0.4f, 0.6914865087}, Case{1.0f, 0.9f, 0.6f, 0.95f, 0.0437722769}}) {
    EXPECT_NEAR(sheen::value(c.cos_m, c.cos_o, c.cos_i, c.alpha), c.value, 1e-4 * c.value) << c.alpha;
  }
}

TEST(SheenEnergy, LookUpsMatchQuadrature) {
  const SheenEnergyTable table = sheen_energy_table();
  for (const float alpha : {0.012f, 0.03f, 0.1f, 0.3f, 0.7f, 1.0f}) {
    for (const float cos_o : {1.0f, 0.7f, 0.4f, 0.15f, 0.06f, 0.02f}) {
      const double expected = albedo(cos_o, alpha);
      EXPECT_NEAR(table.directional(cos_o, alpha), expected, 5e-3 + 5e-3 * expected) << alpha << ", cos " << cos_o;
    }
  }
}

/// Fibres of very small α are bright only within 1° of the horizon, so the table is coarser for them.
TEST(SheenEnergy, ThinFibresMatchQuadrature) {
  const SheenEnergyTable table = sheen_energy_table();
  for (const float alpha : {kMinSheenAlpha, 3e-4f, 8e-4f}) {
    for (const float cos_o : {1.0f, 0.3f, 0.1f, 0.05f, 0.02f, 0.01f}) {
      const double expected = albedo(cos_o, alpha);
      EXPECT_NEAR(table.directional(cos_o, alpha), expected, 0.01 + 0.08 * expected) << alpha << ", cos " << cos_o;
    }
  }
  EXPECT_LT(table.directional(0.1f, kMinSheenAlpha), 1e-3f);
}

/// ∫ D cos θ = 1 ([Estevez17], eq. 2).
TEST(SheenEnergy, NormalsAreNormalized) {
  for (const float alpha : {0.02f, 0.2f, 1.0f}) {
    double sum = 0;
    constexpr int kSteps = 20000;
    for (int i = 0; i < kSteps; ++i) {
      const double cos_m = (i + 0.5) / kSteps;
      sum += double{sheen::d(static_cast<float>(cos_m), alpha)} * cos_m * 2 * M_PI / kSteps;
    }
    EXPECT_NEAR(sum, 1.0, 1e-3) << alpha;
  }
}

}  // namespace
}  // namespace relume
