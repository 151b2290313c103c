#include "metrics/ensemble.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/hash.h"
#include "relume/error.h"

namespace relume {
namespace {

/// 0.5 plus noise of variance `variance`, plus `bias`.
Image make_noisy(uint32_t seed, float variance, float bias) {
  Image image(96, 80);
  const float half_width = std::sqrt(3.0f * variance);  // of the uniform distribution
  uint32_t i = 0;
  for (Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) pixel[c] = 0.5f + bias + half_width * (2.0f * to_unit_float(hash(seed, ++i)) - 1.0f);
  }
  return image;
}

Image make_constant(float value) {
  Image image(96, 80);
  for (Rgb& pixel : image.pixels) pixel = Rgb(value);
  return image;
}

TEST(Ensemble, SplitsNoiseFromBias) {
  Ensemble ensemble;
  for (uint32_t seed = 1; seed <= 5; ++seed) ensemble.add(make_noisy(seed, 0.01f, 0.03f));
  const ErrorSplit split = ensemble.split(make_constant(0.5f));
  // 23 040 values of five draws each: the relative error of the variance is about 0.5 %.
  EXPECT_NEAR(split.variance, 0.01, 0.01 * 0.02);
  ASSERT_TRUE(split.bias2_error);
  EXPECT_NEAR(split.bias2, 0.0009, 5 * *split.bias2_error);
  EXPECT_LT(*split.bias2_error, 1e-4);
  EXPECT_EQ(split.pixels, 96u * 80u);
}

TEST(Ensemble, ABiasInOnePlaceIsAsCertainAsOneEverywhere) {
  Ensemble ensemble;
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    Image image = make_noisy(seed, 0.01f, 0.0f);
    for (int y = 32; y < 48; ++y) {
      for (int x = 16; x < 32; ++x) image.at(x, y) += Rgb(0.3f);
    }
    ensemble.add(image);
  }
  const ErrorSplit split = ensemble.split(make_constant(0.5f));
  const double expected = 0.09 * 16 * 16 / (96 * 80);
  ASSERT_TRUE(split.bias2_error);
  EXPECT_NEAR(split.bias2, expected, 5 * *split.bias2_error);
  EXPECT_GT(split.bias2, 10 * *split.bias2_error);
}

TEST(Ensemble, ManyRepetitionsReduceTheErrorOfTheBias) {
  const auto split_of = [](uint32_t count) {
    Ensemble ensemble;
    for (uint32_t seed = 1; seed <= count; ++seed) ensemble.add(make_noisy(seed, 0.01f, 0.03f));
    return ensemble.split(make_constant(0.5f));
  };
  const ErrorSplit few = split_of(8);
  const ErrorSplit many = split_of(83);  // groups of eleven and ten
  EXPECT_NEAR(many.bias2, 0.0009, 5 * *many.bias2_error);
  EXPECT_LT(*many.bias2_error, 0.7 * *few.bias2_error);  // expected: a fifth; each is only accurate to about a quarter
}

TEST(Ensemble, WithoutBiasTheEstimateScattersAroundZero) {
  int negative = 0;
  int certain = 0;
  for (uint32_t trial = 0; trial < 20; ++trial) {
    Ensemble ensemble;
    for (uint32_t seed = 1; seed <= 6; ++seed) ensemble.add(make_noisy(100 * trial + seed, 0.04f, 0.0f));
    const ErrorSplit split = ensemble.split(make_constant(0.5f));
    EXPECT_LT(std::fabs(split.bias2), 4.5 * *split.bias2_error);
    certain += split.bias2 > 2 * *split.bias2_error;
    negative += split.bias2 < 0;
  }
  EXPECT_GT(negative, 2);  // of 20; 1 or 0 has probability 2e-5 if both signs are equally likely
  EXPECT_LT(negative, 18);
  EXPECT_LE(certain, 2);  // expected: some 2 % of such trials, because two standard errors are overestimated 1.6 times
}

TEST(Ensemble, ReferenceNoiseIsNotBias) {
  Ensemble ensemble;
  for (uint32_t seed = 1; seed <= 5; ++seed) ensemble.add(make_noisy(seed, 0.01f, 0.0f));
  const Image reference = make_noisy(99, 0.002f, 0.0f);
  EXPECT_GT(ensemble.split(reference).bias2, 0.0015);
  const ErrorSplit split = ensemble.split(reference, 0.002);
  EXPECT_LT(std::fabs(split.bias2), 4.5 * *split.bias2_error);
}

TEST(Ensemble, ExcludesNonFinitePixelsAndRejectsSingleImages) {
  Ensemble ensemble;
  Image broken = make_constant(0.5f);
  broken.at(3, 4).g = std::nanf("");
  ensemble.add(broken);
  EXPECT_THROW(ensemble.split(make_constant(0.5f)), Error);
  ensemble.add(make_constant(0.5f));
  const ErrorSplit split = ensemble.split(make_constant(0.25f));
  EXPECT_EQ(split.pixels, 96u * 80u - 1);
  EXPECT_DOUBLE_EQ(split.bias2, 0.0625);
  EXPECT_FALSE(split.bias2_error);  // only two repetitions
  EXPECT_THROW(ensemble.add(Image(3, 3)), Error);
}

}  // namespace
}  // namespace relume
