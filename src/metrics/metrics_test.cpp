#include "metrics/metrics.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/error.h"
#include "core/hash.h"
#include "core/srgb.h"

namespace relume {
namespace {

Image make_noise(int width, int height, uint32_t seed) {
  Image image(width, height);
  uint32_t i = 0;
  for (Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = 2.0f * to_unit_float(hash(seed, ++i));
  }
  return image;
}

TEST(Metrics, IdenticalImagesDoNotDiffer) {
  const Image image = make_noise(40, 30, 1);
  const Metrics m = compute_metrics(image, image, {.hdr_flip = true});
  EXPECT_EQ(m.mse, 0.0);
  EXPECT_EQ(m.rel_mse, 0.0);
  EXPECT_EQ(m.mae, 0.0);
  EXPECT_EQ(m.mape, 0.0);
  EXPECT_EQ(m.flip, 0.0);
  EXPECT_EQ(m.hdr_flip, 0.0);
  EXPECT_EQ(m.mean_a, m.mean_b);
  EXPECT_EQ(m.pixels, 1200u);
}

TEST(Metrics, ConstantImagesGiveTheDefinitions) {
  Image a(8, 8);
  Image b(8, 8);
  for (Rgb& pixel : a.pixels) pixel = {0.5f, 1.0f, 0.25f};
  for (Rgb& pixel : b.pixels) pixel = {0.25f, 2.0f, 0.0f};
  const Metrics m = compute_metrics(a, b);
  EXPECT_DOUBLE_EQ(m.mse, (0.0625 + 1.0 + 0.0625) / 3.0);
  EXPECT_DOUBLE_EQ(m.rel_mse, (0.0625 / 0.0725 + 1.0 / 4.01 + 0.0625 / 0.01) / 3.0);
  EXPECT_DOUBLE_EQ(m.mae, 1.5 / 3.0);
  EXPECT_DOUBLE_EQ(m.mape, (0.25 / 0.26 + 1.0 / 2.01 + 0.25 / 0.01) / 3.0);
  EXPECT_EQ(m.mean_a, (std::array<double, 3>{0.5, 1.0, 0.25}));
  EXPECT_EQ(m.mean_b, (std::array<double, 3>{0.25, 2.0, 0.0}));
}

TEST(Metrics, NonFinitePixelsAreLeftOutAndCounted) {
  Image a(10, 10);
  const Image b(10, 10);
  a.at(3, 3).g = std::nanf("");
  a.at(4, 3).r = kInfinity;
  a.at(5, 3).r = 1.0f;
  const Metrics m = compute_metrics(a, b, {.hdr_flip = true});
  EXPECT_EQ(m.nonfinite_a, 2u);
  EXPECT_EQ(m.nonfinite_b, 0u);
  EXPECT_EQ(m.pixels, 98u);
  EXPECT_DOUBLE_EQ(m.mse, 1.0 / (3.0 * 98.0));
  EXPECT_TRUE(std::isfinite(m.flip));
  EXPECT_TRUE(std::isfinite(m.hdr_flip));
}

TEST(Metrics, UnusablePairsAreErrors) {
  EXPECT_THROW(compute_metrics(Image(4, 4), Image(4, 5)), Error);
  EXPECT_THROW(compute_metrics(Image(), Image()), Error);
  EXPECT_THROW(block_differences(Image(4, 4), Image(5, 4)), Error);
  Image nan(2, 2);
  for (Rgb& pixel : nan.pixels) pixel = Rgb(std::nanf(""));
  EXPECT_THROW(compute_metrics(nan, nan), Error);
}

TEST(Metrics, DoNotDependOnTheNumberOfThreads) {
  const Image a = make_noise(123, 77, 1);
  const Image b = make_noise(123, 77, 2);
  const auto with_threads = [&](size_t count) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, count);
    return compute_metrics(a, b, {.hdr_flip = true});
  };
  const Metrics one = with_threads(1);
  const Metrics four = with_threads(4);
  EXPECT_EQ(one.mse, four.mse);
  EXPECT_EQ(one.rel_mse, four.rel_mse);
  EXPECT_EQ(one.mape, four.mape);
  EXPECT_EQ(one.flip, four.flip);
  EXPECT_EQ(one.hdr_flip, four.hdr_flip);
  EXPECT_EQ(one.mean_a, four.mean_a);
}

TEST(BlockDifferences, FindTheBlockThatDiffers) {
  Image b(40, 20);
  for (Rgb& pixel : b.pixels) pixel = Rgb(2.0f);
  Image a = b;
  for (int y = 16; y < 20; ++y) {
    for (int x = 32; x < 40; ++x) a.at(x, y).g = 2.2f;  // the small block in the corner
  }
  const BlockDifferences d = block_differences(a, b);
  EXPECT_EQ(d.columns, 3);
  EXPECT_EQ(d.rows, 2);
  for (size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(d.relative[i].g, i == 5 ? 0.1f : 0.0f, 1e-6f);
    EXPECT_EQ(d.relative[i].r, 0.0f);
  }
  EXPECT_NEAR(d.max_abs, 0.1, 1e-6);
  EXPECT_NEAR(d.rms, 0.1 / std::sqrt(18.0), 1e-6);
}

TEST(BlockDifferences, BlackReferenceBlocksAreBounded) {
  Image a(32, 16);
  Image b(32, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 16; ++x) a.at(x, y) = b.at(x, y) = Rgb(1.0f);
  }
  a.at(20, 5) = Rgb(0.001f);
  const BlockDifferences d = block_differences(a, b);
  // Mean 0.001/256 against the floor 0.001 · 0.5.
  EXPECT_NEAR(d.relative[1].r, 0.001 / 256.0 / 0.0005, 1e-6);
  EXPECT_EQ(block_differences(Image(16, 16), Image(16, 16)).max_abs, 0.0);
}

TEST(ColorMap, RunsFromBlackToLightYellow) {
  const std::vector<float> values{0.0f, 1.0f, 2.0f, -1.0f, std::nanf(""), 0.5f};
  const Image image = color_map(values, 6, 1);
  EXPECT_LT(luminance(image.at(0, 0)), 0.001f);
  EXPECT_NEAR(srgb_from_linear(image.at(1, 0).r), 252.0f / 255.0f, 1e-4f);
  EXPECT_EQ(image.at(2, 0), image.at(1, 0));
  EXPECT_EQ(image.at(3, 0), image.at(0, 0));
  EXPECT_EQ(image.at(4, 0), Rgb(0, 1, 0));
  EXPECT_GT(luminance(image.at(5, 0)), luminance(image.at(0, 0)));
  EXPECT_LT(luminance(image.at(5, 0)), luminance(image.at(1, 0)));
}

TEST(RelativeErrorMap, AveragesToRelMse) {
  const Image a = make_noise(20, 20, 3);
  const Image b = make_noise(20, 20, 4);
  double sum = 0;
  for (const float x : relative_error_map(a, b)) sum += x;
  EXPECT_NEAR(sum / 400.0, compute_metrics(a, b).rel_mse, 1e-5 * sum);  // floats
}

}  // namespace
}  // namespace relume
