#include "experiments/measure/edges.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr int kWidth = 8;
constexpr int kHeight = 6;

/// Two surfaces that meet between the columns 3 and 4, with a shadow on the left of column 1.
Reference two_surfaces() {
  Reference reference;
  reference.image = Image(kWidth, kHeight);
  reference.squared_error = Image(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      reference.image.at(x, y) = Rgb(x < 1 ? 0.5f : 1.0f);
      reference.surface.depth.push_back(x < 4 ? 2.0f : 3.0f);
      reference.surface.normal.emplace_back(0, 0, 1);
    }
  }
  return reference;
}

TEST(Edges, AreThoseOfDepthAndOfLight) {
  const Reference reference = two_surfaces();
  const PixelMask depth = depth_edges(reference);
  const PixelMask shadow = shadow_edges(reference);
  for (size_t p = 0; p < depth.mask.size(); ++p) {
    const size_t x = p % kWidth;
    EXPECT_EQ(depth.mask[p] != 0, x == 3 || x == 4) << p;
    EXPECT_EQ(shadow.mask[p] != 0, x == 0 || x == 1) << p;
  }
  EXPECT_EQ(pixels_in(depth).size(), 2u * kHeight);
}

TEST(Edges, OfDepthEndAtTheBackground) {
  Reference reference = two_surfaces();
  for (size_t p = 0; p < reference.surface.depth.size(); ++p) {
    if (p % kWidth < 4) continue;
    reference.surface.depth[p] = 0;
    reference.surface.normal[p] = Vec3(0);
  }
  const PixelMask depth = depth_edges(reference);
  for (size_t p = 0; p < depth.mask.size(); ++p) EXPECT_EQ(depth.mask[p] != 0, p % kWidth == 3 || p % kWidth == 4) << p;
}

TEST(Edges, OfLightExceedTheNoise) {
  Reference reference = two_surfaces();
  for (Rgb& pixel : reference.squared_error.pixels) pixel = Rgb(0.02f);
  EXPECT_EQ(shadow_edges(reference).pixels(), 0u);
}

TEST(EdgeBlocks, HaveEnoughPixels) {
  const PixelMask depth = depth_edges(two_surfaces());
  const std::vector<EdgeBlock> blocks = blocks_of(depth, kWidth, kHeight, 4, 4);
  ASSERT_EQ(blocks.size(), 2u) << "the lower row of blocks has two rows of pixels, so two edge pixels in each block";
  EXPECT_EQ(blocks[0].x, 0);
  EXPECT_EQ(blocks[1].x, 4);
  EXPECT_EQ(blocks[1].y, 0);
  EXPECT_EQ(blocks[0].pixels.size(), 4u);
  EXPECT_EQ(blocks_of(depth, kWidth, kHeight, 4, 2).size(), 4u);
}

TEST(BlockBias, IsMeasuredInErrorsOfRunsAndReference) {
  Reference reference = two_surfaces();
  for (Rgb& pixel : reference.squared_error.pixels) pixel = Rgb(0.0016f);
  std::vector<Image> runs;
  for (const float value : {1.1f, 1.3f}) {
    Image image(kWidth, kHeight);
    for (Rgb& pixel : image.pixels) pixel = Rgb(value);
    runs.push_back(std::move(image));
  }
  const BlockBias bias = block_bias(runs, reference, {6, 7});
  EXPECT_NEAR(bias.reference, 1, 1e-6);
  EXPECT_NEAR(bias.bias, 0.2, 1e-6);
  EXPECT_NEAR(bias.error, std::sqrt(0.02 / 2 + 0.0016 / 2), 1e-6);
  EXPECT_NEAR(bias.significance(), 0.2 / bias.error, 1e-6);
}

}  // namespace
}  // namespace relume
