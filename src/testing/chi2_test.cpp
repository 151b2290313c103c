// The χ² test accepts correct densities and rejects slightly wrong ones.
#include "testing/chi2.h"

#include <gtest/gtest.h>

#include "sampling/warp.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume::testing {
namespace {

constexpr int kSamples = 100000;

TEST(Chi2, SurvivalMatchesClosedForms) {
  for (const double x : {0.01, 0.5, 1.0, 3.0, 10.0, 40.0}) {
    EXPECT_NEAR(chi2_survival(x, 1), std::erfc(std::sqrt(0.5 * x)), 1e-11);
    EXPECT_NEAR(chi2_survival(x, 2), std::exp(-0.5 * x), 1e-11);
    EXPECT_NEAR(chi2_survival(x, 4), std::exp(-0.5 * x) * (1.0 + 0.5 * x), 1e-11);
  }
  // The median of χ² is about k (1 − 2/9k)³ (Wilson and Hilferty).
  for (const int k : {10, 100, 1000}) EXPECT_NEAR(chi2_survival(k * std::pow(1.0 - 2.0 / (9.0 * k), 3), k), 0.5, 2e-3);
}

TEST(Chi2, SignificanceBoundsTheWholeSuite) {
  EXPECT_NEAR(1.0 - std::pow(1.0 - significance(), kSuiteTests), kSuiteSignificance, 1e-9);
}

TEST(Chi2, PoolsThinBins) {
  const std::vector<uint64_t> observed{5, 4, 6, 100};
  const std::vector<double> expected{5, 5, 5, 100};
  const Chi2Result r = chi2_test(observed, expected);
  EXPECT_EQ(r.dof, 1);  // the first two thin bins are pooled, the third joins the last
  EXPECT_NEAR(r.statistic, 0.1 + 1.0 / 105.0, 1e-12);
}

TEST(Chi2, RejectsSamplesWhereNothingIsExpected) {
  const std::vector<uint64_t> observed{100, 1};
  const std::vector<double> expected{101, 0};
  EXPECT_EQ(chi2_test(observed, expected).p_value, 0.0);
  EXPECT_GT(chi2_test(observed, expected, 0.01).p_value, 0.5);
}

Chi2Result test_cosine(double exponent, double scale) {
  Random random(1);
  Histogram histogram(16);
  const DirectionChart chart{local_frame(), 1.0};
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 p = chart.coordinates(cosine_hemisphere_from_square(random.next_2d()));
    histogram.add(p.x, p.y);
  }
  const auto pdf = [&](const Vec3& w) { return w.z > 0.0f ? scale * std::pow(double(w.z), exponent) / M_PI : 0.0; };
  return histogram.test(chart.density(pdf), 8);
}

TEST(Chi2, AcceptsTheRightDensity) { EXPECT_GT(test_cosine(1.0, 1.0).p_value, significance()); }

TEST(Chi2, RejectsSlightlyWrongDensities) {
  EXPECT_LT(test_cosine(1.1, 1.05).p_value, significance());  // normalised: (1.1 + 1) / 2
  EXPECT_LT(test_cosine(1.0, 0.97).p_value, significance());  // integrates to 0.97
}

TEST(Chi2, RejectsLostSamples) {
  Random random(2);
  Histogram histogram(8);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2 u = random.next_2d();
    if (random.next() < 0.003f) {
      histogram.add_outside();
    } else {
      histogram.add(u.x, u.y);
    }
  }
  EXPECT_LT(histogram.test([](double, double) { return 1.0; }).p_value, significance());
}

TEST(Histogram, ChartIsAMeasurePreservingBijection) {
  Random random(3);
  for (const double width : {1e-3, 0.05, 1.0}) {
    const DirectionChart chart{make_frame(random.direction()), width};
    const auto one = [](const Vec3&) { return 1.0; };
    // The chart is smooth, so quadrature reaches its tolerance.
    EXPECT_NEAR(integrate_square(chart.density(one), 8, 1e-6, 8), 4.0 * M_PI, 1e-4);
    for (int i = 0; i < 1000; ++i) {
      const Vec2 u = random.next_2d();
      double solid_angle;
      const Vec2 back = chart.coordinates(chart.direction(u.x, u.y, &solid_angle));
      // A float direction resolves angles to about 1e-7, spread over the width.
      EXPECT_NEAR(back.x, u.x, 1e-6 / width + 1e-6);
      const float turn = std::fabs(back.y - u.y);
      EXPECT_LT(std::fmin(turn, 1.0f - turn), 1e-6 / (width * u.x + 1e-9) + 1e-5) << u.x << ' ' << width;
    }
  }
}

TEST(Integrate, FindsDiscontinuities) {
  const auto quarter_disk = [](double x, double y) { return x * x + y * y < 1.0 ? 1.0 : 0.0; };
  // Quadrature misses a sliver of a cell that contains none of its 36 points; 16 × 16 cells keep slivers small.
  EXPECT_NEAR(integrate_square(quarter_disk, 16, 1e-7, 8), M_PI / 4, 1e-4);
}

}  // namespace
}  // namespace relume::testing
