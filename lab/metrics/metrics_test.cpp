#include "relume/lab/metrics.h"

#include <cmath>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/hash.h"
#include "core/srgb.h"
#include "relume/error.h"

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
  EXPECT_NEAR(sum / 400.0, compute_metrics(a, b).rel_mse, 1e-5 * sum);  // float precision
}

}  // namespace
}  // namespace relume
