#include "techniques/temporal/accumulate/sample_sums.h"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(SampleSums, AddCompleteBlocksToTheSums) {
  const std::vector<Rgb> radiance{Rgb(1), Rgb(std::numeric_limits<float>::quiet_NaN())};
  std::vector<SampleBlock> blocks(2);
  std::vector<RadianceSums> sums(2);
  SampleSumsKernel kernel{view_of(radiance), mutable_view_of(blocks), mutable_view_of(sums), false, 2};
  for (uint32_t i = 0; i < kBlockSamples; ++i) {
    EXPECT_EQ(sums[0].r.value(), 0);
    EXPECT_EQ(blocks[0].r, i);
    kernel.ends_block = i + 1 == kBlockSamples;
    for (const uint32_t pixel : {0u, 1u}) kernel(pixel, 0);
  }
  EXPECT_EQ(sums[0].mean(kBlockSamples), Rgb(1));
  EXPECT_EQ(sums[1].mean(kBlockSamples), Rgb(0)) << "samples that are not finite count as black";
  EXPECT_EQ(blocks[0].r, 0);
}

TEST(SampleSums, AddSurfaces) {
  const std::vector<Rgb> albedo{Rgb(0.5f)};
  const std::vector<Vec3> normal{Vec3(0, 0, -1)};
  const std::vector<float> depth{2};
  std::vector<SurfaceSums> sums(1);
  const SurfaceSumsKernel kernel{view_of(albedo), view_of(normal), view_of(depth), mutable_view_of(sums), 1};
  for (int i = 0; i < 3; ++i) kernel(0, 0);
  EXPECT_EQ(mean_of(sums[0].albedo[1], 3), 0.5f);
  EXPECT_EQ(mean_of(sums[0].normal[2], 3), -1.0f);
  EXPECT_EQ(mean_of(sums[0].depth, 3), 2.0f);
}

}  // namespace
}  // namespace relume
