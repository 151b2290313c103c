#include "sampling/von_mises_fisher.h"

#include <gtest/gtest.h>

#include <cmath>

#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

constexpr float kConcentrations[] = {0, 0.005f, 0.01f, 0.1f, 1, 10, 300, 1e4f};

VonMisesFisher lobe(float concentration) { return {glm::normalize(Vec3(0.3f, -0.5f, 0.2f)), concentration}; }

testing::DirectionChart chart_of(const VonMisesFisher& lobe) {
  return {make_frame(lobe.axis), 1.0 / std::sqrt(1.0 + static_cast<double>(lobe.concentration))};
}

TEST(VonMisesFisher, IntegratesToOne) {
  for (const float concentration : kConcentrations) {
    const VonMisesFisher f = lobe(concentration);
    const testing::DirectionChart chart = chart_of(f);
    const auto pdf = [&](const Vec3& w) { return static_cast<double>(f.pdf(w)); };
    EXPECT_NEAR(testing::integrate_square(chart.density(pdf), 16, 1e-5, 5), 1.0, 2e-4) << concentration;
  }
}

TEST(VonMisesFisher, SamplesFollowTheDensity) {
  constexpr int kSamples = 100000;
  for (const float concentration : kConcentrations) {
    const VonMisesFisher f = lobe(concentration);
    const testing::DirectionChart chart = chart_of(f);
    testing::Histogram histogram(16);
    testing::Random random(5);
    for (int i = 0; i < kSamples; ++i) {
      const Vec3 w = f.sample(random.next_2d());
      ASSERT_NEAR(glm::length(w), 1.0f, 1e-5f);
      const Vec2 p = chart.coordinates(w);
      histogram.add(static_cast<double>(p.x), static_cast<double>(p.y));
    }
    const auto pdf = [&](const Vec3& w) { return static_cast<double>(f.pdf(w)); };
    EXPECT_GT(histogram.test(chart.density(pdf)).p_value, testing::significance()) << concentration;
  }
}

TEST(VonMisesFisher, IsFiniteAtTheLimits) {
  for (const float concentration : kConcentrations) {
    const VonMisesFisher f = lobe(concentration);
    for (const float x : {0.0f, 1e-30f, 0.5f, kOneMinusEpsilon}) {
      for (const float y : {0.0f, kOneMinusEpsilon}) {
        const Vec3 w = f.sample({x, y});
        ASSERT_TRUE(is_finite(w)) << concentration;
        ASSERT_TRUE(is_finite(f.pdf(w)) && f.pdf(w) > 0.0f) << concentration << ' ' << x;
      }
    }
    EXPECT_TRUE(is_finite(f.pdf(f.axis)) && f.pdf(-f.axis) >= 0.0f) << concentration;
  }
}

TEST(VonMisesFisher, ConcentrationGrowsWithTheMeanCosineUpToALimit) {
  EXPECT_EQ(VonMisesFisher::concentration_of(0), 0.0f);
  EXPECT_EQ(VonMisesFisher::concentration_of(-1), 0.0f);
  EXPECT_EQ(VonMisesFisher::concentration_of(1e-4f), 0.0f);
  float last = 0;
  for (const float r : {0.01f, 0.1f, 0.5f, 0.9f, 0.999f}) {
    const float kappa = VonMisesFisher::concentration_of(r);
    EXPECT_GT(kappa, last);
    last = kappa;
    // The mean cosine of a lobe is coth κ − 1/κ. The approximation is within 2 %.
    const double mean = 1.0 / std::tanh(static_cast<double>(kappa)) - 1.0 / static_cast<double>(kappa);
    EXPECT_NEAR(mean, static_cast<double>(r), 0.02 * static_cast<double>(r) + 1e-4) << r;
  }
  EXPECT_EQ(VonMisesFisher::concentration_of(1), VonMisesFisher::kMostConcentration);
  EXPECT_EQ(VonMisesFisher::concentration_of(kInfinity), VonMisesFisher::kMostConcentration);
}

}  // namespace
}  // namespace relume
