#include "materials/dispersion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "materials/testing/bsdf_cases.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

constexpr int kSteps = 4000;
constexpr double kStepNm = (kLongestWavelength - kShortestWavelength) / static_cast<double>(kSteps);

/// ∫ f(λ) dλ over the range of wavelengths, by the midpoint rule.
template <typename F>
glm::dvec3 integral(const F& f) {
  glm::dvec3 sum(0);
  for (int i = 0; i < kSteps; ++i)
    sum += glm::dvec3(f(kShortestWavelength + static_cast<float>((i + 0.5) * kStepNm))) * kStepNm;
  return sum;
}

TEST(Dispersion, EachResponseIntegratesToOne) {
  const glm::dvec3 mass = integral([](float nm) { return channel_response(nm); });
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mass[c], 1.0, 1e-5) << c;
  for (int i = 0; i < kSteps; ++i) {
    const Rgb s = channel_response(kShortestWavelength + static_cast<float>(i * kStepNm));
    EXPECT_GT(min(s.r, min(s.g, s.b)), 0.0f);
    EXPECT_TRUE(is_finite(s));
  }
}

TEST(Dispersion, ResponsesPeakAtThePrimaries) {
  const float peaks[] = {611.4f, 549.1f, 464.2f};
  for (int c = 0; c < 3; ++c) {
    for (const float step : {-5.0f, 5.0f})
      EXPECT_GT(channel_response(peaks[c])[c], channel_response(peaks[c] + step)[c]) << c;
  }
}

TEST(Dispersion, WeightsAverageToWhite) {
  const glm::dvec3 mean = integral([](float nm) { return wavelength_weight(nm) * wavelength_pdf(nm); });
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c], 1.0, 1e-5) << c;
  for (int i = 0; i < kSteps; ++i) {
    const Rgb w = wavelength_weight(kShortestWavelength + static_cast<float>(i * kStepNm));
    EXPECT_NEAR(w.r + w.g + w.b, 3.0f, 1e-5f);
    EXPECT_GT(min(w.r, min(w.g, w.b)), 5e-4f);  // throughput can be divided by the weight
  }
}

int bin_of(float nm, int bins) {
  const float at = (nm - kShortestWavelength) / (kLongestWavelength - kShortestWavelength);
  return std::min(static_cast<int>(at * static_cast<float>(bins)), bins - 1);
}

TEST(Dispersion, WavelengthsFollowTheirDensity) {
  constexpr int kBins = 100;
  constexpr int kSamples = 200000;
  std::vector<uint64_t> counts(kBins, 0);
  testing::Random random(7);
  for (int i = 0; i < kSamples; ++i) {
    const float nm = sample_wavelength(random.next());
    ASSERT_GE(nm, kShortestWavelength);
    ASSERT_LE(nm, kLongestWavelength);
    ++counts[static_cast<size_t>(bin_of(nm, kBins))];
  }
  std::vector<double> expected(kBins, 0);
  for (int i = 0; i < kSteps; ++i) {
    const float nm = kShortestWavelength + static_cast<float>((i + 0.5) * kStepNm);
    expected[static_cast<size_t>(bin_of(nm, kBins))] += kSamples * kStepNm * static_cast<double>(wavelength_pdf(nm));
  }
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
}

TEST(Dispersion, TheEndsOfTheIntervalHaveWavelengths) {
  for (const float u : {0.0f, 1.0f / 3, 2.0f / 3, kOneMinusEpsilon}) {
    const float nm = sample_wavelength(u);
    EXPECT_TRUE(nm >= kShortestWavelength && nm <= kLongestWavelength) << u;
  }
}

/// V_d = (n_d − 1) / (n_F − n_C) at the lines of hydrogen F and C.
TEST(Dispersion, HasTheAbbeNumber) {
  for (const float ior : {1.33f, 1.5168f, 2.42f}) {
    for (const float abbe : {20.0f, 64.2f, 90.0f}) {
      const auto index = [&](float nm) { return static_cast<double>(index_at(ior, 20.0f / abbe, nm)); };
      EXPECT_NEAR((ior - 1.0) / (index(486.13f) - index(656.27f)) / abbe, 1.0, 2e-3) << ior << ", " << abbe;
      EXPECT_NEAR(index(587.56f), ior, 2e-5 * ior) << ior << ", " << abbe;
    }
  }
}

TEST(Dispersion, IsOffWithoutParameterOrWavelength) {
  for (const float ior : {1.0f, 1.33f, 1.5f, 2.42f}) {
    EXPECT_EQ(index_at(ior, 0, 450), ior);
    EXPECT_EQ(index_at(ior, 1, kNoWavelength), ior);
    EXPECT_EQ(index_at(1, 20, 450), 1.0f);
  }
}

TEST(Dispersion, NoMediumIsThinnerThanAir) {
  for (const float ior : {1.01f, 1.33f, 2.42f, 1000.0f})
    EXPECT_GT((index_at(ior, 20, kLongestWavelength) - 1) / (ior - 1), 0.3f) << ior;
}

/// Light of each channel that a smooth dispersive interface transmits, weighted by its wavelength, and reflects. From
/// inside, reflected light has the weight, too.
glm::dvec3 light_from_interface(float ior, float dispersion, float cosine, bool front_face) {
  MaterialSample sample;
  sample.metallic = 0;
  sample.transmission = 1;
  sample.roughness = 0;
  MaterialData data;
  data.volume = true;
  data.ior = ior;
  return integral([&](float nm) {
    sample.ior = index_at(ior, dispersion, nm);
    Bsdf bsdf{};
    make_bsdf(bsdf, sample, data, energy_tables(), cosine, front_face);
    const float reflected = dielectric::reflectance(bsdf.interface, cosine).g;
    const Rgb weight = wavelength_weight(nm);
    const Rgb without = front_face ? Rgb(1) : weight;
    return (without * reflected + weight * (1.0f - reflected)) * wavelength_pdf(nm);
  });
}

/// Reflectance at normal incidence is that of the d line. At other angles it depends on the wavelength slightly, with
/// the bounds of docs/materials.md.
TEST(Dispersion, SmoothInterfacesLoseNoChannel) {
  struct Bound {
    float ior;
    double error;  ///< from outside, at `dispersion` 1
  };
  for (const Bound& bound : {Bound{1.33f, 2.5e-3}, {1.5f, 1.2e-3}, {1.7f, 5e-4}, {2.0f, 2.2e-3}, {2.42f, 4.2e-3}}) {
    double largest = 0;
    for (const float cosine : {1.0f, 0.8f, 0.5f, 0.23f, 0.17f, 0.12f, 0.08f, 0.05f}) {
      const glm::dvec3 outside = light_from_interface(bound.ior, 1, cosine, true);
      const glm::dvec3 inside = light_from_interface(bound.ior, 1, cosine, false);
      for (int c = 0; c < 3; ++c) {
        largest = std::max(largest, std::fabs(outside[c] - 1.0));
        EXPECT_NEAR(inside[c], 1.0, 1e-5) << bound.ior << ", cos " << cosine << ", channel " << c;
      }
    }
    EXPECT_LT(largest, bound.error) << bound.ior;
    EXPECT_GT(largest, 0.9 * bound.error) << bound.ior;
  }
}

}  // namespace
}  // namespace relume
