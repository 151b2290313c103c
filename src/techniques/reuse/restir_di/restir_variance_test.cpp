#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "framebuffer/pixel_moments.h"
#include "render/session.h"
#include "techniques/reuse/restir_di/testing/lamps_over_plate.h"

namespace relume {
namespace {

constexpr int kSize = 16;
constexpr size_t kPixels = size_t{kSize} * kSize;
constexpr int kSeeds = 48;
constexpr int kCap = 4;
constexpr uint32_t kFrames = 36;  ///< four times 1 + 2 · cap

/// A run's image and its estimates.
struct Estimates {
  std::vector<double> mean;      ///< luminance by pixel
  std::vector<double> variance;  ///< of that, as estimated
  double error = 0;              ///< relative, of the image, as estimated
};

struct Runs {
  std::vector<Estimates> runs;
  std::vector<double> mean;      ///< over the runs, by pixel
  std::vector<double> variance;  ///< of one run's mean, by pixel, from the spread over the runs
};

Runs render(const RestirSettings& restir) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.path.max_bounces = 1;
  settings.reuse = ReuseChoice::restir_di;
  settings.restir = restir;
  settings.stratify = false;  // candidates of frames are independent, as the estimate supposes
  Session session(testing::half_hidden_lamps(), settings);
  Runs result{{}, std::vector<double>(kPixels), std::vector<double>(kPixels)};
  for (int seed = 1; seed <= kSeeds; ++seed) {
    session.restart(seed);
    for (uint32_t frame = 0; frame < kFrames; ++frame) session.render_frame();
    Estimates run;
    for (const Rgb& pixel : session.image().pixels) run.mean.push_back(static_cast<double>(luminance(pixel)));
    const std::vector<float> variance = session.aov("variance").front().values;
    for (const float v : variance) run.variance.push_back(static_cast<double>(v));
    run.error = session.estimated_error();
    result.runs.push_back(std::move(run));
  }
  for (size_t p = 0; p < kPixels; ++p) {
    for (const Estimates& run : result.runs) result.mean[p] += run.mean[p] / kSeeds;
    for (const Estimates& run : result.runs) {
      const double difference = run.mean[p] - result.mean[p];
      result.variance[p] += difference * difference / (kSeeds - 1);
    }
  }
  return result;
}

const Runs& own_histories() {
  static const Runs runs = render({.cap = kCap, .neighbours = 0});
  return runs;
}

/// Estimated variance over that of the runs, both summed over the pixels.
double variance_ratio(const Runs& runs) {
  double estimated = 0;
  double actual = 0;
  for (size_t p = 0; p < kPixels; ++p) {
    for (const Estimates& run : runs.runs) estimated += run.variance[p] / kSeeds;
    actual += runs.variance[p];
  }
  return estimated / actual;
}

/// Share of the pixels of all runs within two standard errors of the mean, with the estimated variances times `factor`.
double coverage(const Runs& runs, double factor) {
  size_t within = 0;
  for (const Estimates& run : runs.runs) {
    for (size_t p = 0; p < kPixels; ++p) {
      const double difference = std::fabs(run.mean[p] - runs.mean[p]);
      within += difference <= 2 * std::sqrt(factor * run.variance[p]) ? 1 : 0;
    }
  }
  return static_cast<double>(within) / static_cast<double>(runs.runs.size() * kPixels);
}

/// What estimates for independent frames would be.
double independent() { return 1 / correlation_factor(kFrames, 1 + 2 * kCap); }

/// With its own history alone, a pixel's light is a moving average, for which the factor is exact once the history has
/// its full weight.
TEST(RestirVariance, IsThatOfTheSpreadOverSeeds) {
  const Runs& runs = own_histories();
  EXPECT_GT(variance_ratio(runs), 0.9);
  EXPECT_LT(variance_ratio(runs), 1.6);
  EXPECT_GT(coverage(runs, 1), 0.8);
  EXPECT_LT(independent() * variance_ratio(runs), 0.2) << "independent frames would have a fifth of the variance";
  EXPECT_LT(coverage(runs, independent()), 0.65);
}

/// Estimates of the image's error see the same.
TEST(RestirVariance, GivesTheErrorOfTheImage) {
  const Runs& runs = own_histories();
  double estimated = 0;
  for (const Estimates& run : runs.runs) estimated += run.error / kSeeds;
  double variance = 0;
  double light = 0;
  for (size_t p = 0; p < kPixels; ++p) {
    variance += runs.variance[p];
    light += runs.mean[p] / kPixels;
  }
  const double actual = std::sqrt(variance / kPixels) / light;
  EXPECT_GT(estimated, 0.93 * actual);
  EXPECT_LT(estimated, 1.3 * actual);
}

/// Neighbours mix histories, so a pixel forgets its own sooner: the estimate is an upper bound.
TEST(RestirVariance, IsAnUpperBoundWithNeighbours) {
  const Runs runs = render({.cap = kCap, .neighbours = 3, .radius = 4});
  EXPECT_GT(variance_ratio(runs), 0.9);
  EXPECT_LT(variance_ratio(runs), 1 + 2 * kCap);
  EXPECT_GT(coverage(runs, 1), 0.8);
}

}  // namespace
}  // namespace relume
