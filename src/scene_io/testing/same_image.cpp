#include "scene_io/testing/same_image.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "relume/image_io.h"
#include "render/session.h"

namespace relume::testing {
namespace {

/// Means of 4 × 4 blocks of a small rendering over several seeds.
struct Blocks {
  std::vector<double> mean;
  std::vector<double> variance;  ///< of the mean
};

Blocks render(const Scene& scene, int seed) {
  constexpr int kSide = 24, kBlock = 6, kRuns = 8;
  std::vector<std::vector<double>> runs;
  for (int run = 0; run < kRuns; ++run) {
    RenderSettings settings;
    settings.width = settings.height = kSide;
    settings.seed = static_cast<decltype(settings.seed)>(seed + run);
    Session session(scene, settings);
    for (int frame = 0; frame < 8; ++frame) session.render_frame();
    const Image image = *session.snapshot();
    std::vector<double> sums((kSide / kBlock) * (kSide / kBlock));
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        const Rgb& p = image.at(x, y);
        sums[static_cast<size_t>(y / kBlock * (kSide / kBlock) + x / kBlock)] += static_cast<double>(p.r + p.g + p.b);
      }
    }
    runs.push_back(sums);
  }
  Blocks blocks;
  for (size_t i = 0; i < runs[0].size(); ++i) {
    double mean = 0, squares = 0;
    for (const auto& run : runs) mean += run[i] / kRuns;
    for (const auto& run : runs) squares += (run[i] - mean) * (run[i] - mean);
    blocks.mean.push_back(mean);
    blocks.variance.push_back(squares / (kRuns - 1) / kRuns);
  }
  return blocks;
}

}  // namespace

void expect_same_image(const Scene& expected_scene, const Scene& found_scene) {
  const Blocks expected = render(expected_scene, 100);
  const Blocks found = render(found_scene, 500);
  for (size_t i = 0; i < expected.mean.size(); ++i) {
    const double deviation = std::sqrt(expected.variance[i] + found.variance[i]);
    // 5.5 deviations, and the rounding of 8-bit textures and of the tables.
    EXPECT_NEAR(found.mean[i], expected.mean[i], 5.5 * deviation + 4e-3 * expected.mean[i]) << "block " << i;
  }
}

}  // namespace relume::testing
