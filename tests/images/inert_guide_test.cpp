// Tests the error of path guiding that samples all directions from the BSDF: it can differ from path tracing only by
// its random numbers.
#include <gtest/gtest.h>

#include <vector>

#include "builtin_scenes/builtin.h"
#include "experiments/measure/ratio.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kFrames = 64;
constexpr int kSeeds = 24;

/// Mean squared deviation of each image from the mean of all: the error of an unbiased technique, without a reference.
std::vector<double> errors_of(const Moments& moments) {
  std::vector<double> errors;
  for (const Image& image : moments.images) errors.push_back(mse(image, moments.mean_image()));
  return errors;
}

TEST(SlowInertGuide, KeepsTheStratificationOfAccumulatedFrames) {
  if (is_host_replaced()) GTEST_SKIP() << "the same bits as on the host, which takes minutes";
  const Scene scene = find_builtin_scene("cornell-closed")->build();
  const RenderSettings plain = small_settings(64, 48);
  const std::vector<double> expected = errors_of(measure(scene, plain, kFrames, kSeeds, 1));
  const auto ratio_to_plain = [&](int longest_epoch) {
    RenderSettings s = plain;
    s.guide = GuideChoice::cdq;
    s.cdq.bsdf_fraction = 1;
    s.octree.longest_epoch = longest_epoch;
    return paired_error_ratio(errors_of(measure(scene, s, kFrames, kSeeds, 1)), expected);
  };
  const Ratio inert = ratio_to_plain(OctreeSettings{}.longest_epoch);
  RecordProperty("ratio", to_text(inert));
  EXPECT_LE(inert.interval.high, 1.1) << to_text(inert);
  // The bound detects random numbers that are independent in every frame.
  const Ratio independent = ratio_to_plain(1);
  RecordProperty("independent", to_text(independent));
  EXPECT_GT(independent.interval.low, 1.1) << to_text(independent);
}

}  // namespace
}  // namespace relume::support
