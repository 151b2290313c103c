#include "experiments/measure/regions.h"

#include <random>

#include <gtest/gtest.h>

namespace relume {
namespace {

/// A bright upper left quarter on grey.
Image quarter() {
  Image image(32, 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) image.at(x, y) = Rgb(x < 16 && y < 16 ? 0.8f : 0.2f);
  }
  return image;
}

TEST(Regions, AreCutOut) {
  const Image image = quarter();
  EXPECT_NEAR(region_mean(image, {"bright", 0, 0, 0.5, 0.5}), 0.8, 1e-6);
  EXPECT_NEAR(region_mean(image, {"right", 0.5, 0, 1, 1}), 0.2, 1e-6);
  EXPECT_NEAR(frame_mse(image, Image(32, 32), mask_of({"right", 0.5, 0, 1, 1}, 32, 32)), 0.04, 1e-6);
  EXPECT_NEAR(frame_mse(image, Image(32, 32), mask_of({"image"}, 32, 32)), (0.64 + 3 * 0.04) / 4, 1e-6);
}

TEST(Regions, ErrorsOfAComparisonAreWithoutTheReferencesNoise) {
  Comparison comparison;
  comparison.reference.image = Image(32, 32);
  comparison.reference.squared_error = Image(32, 32);
  comparison.contenders.emplace_back().name = "noisy";
  comparison.contenders[0].images = {Image(32, 32), Image(32, 32)};
  comparison.contenders.emplace_back().name = "clean";
  comparison.contenders[1].images.assign(2, Image(32, 32));
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 32; ++x) {
      comparison.contenders[0].images[0].at(x, y) = Rgb(x < 16 ? 0.5f : 0.1f);
      comparison.contenders[0].images[1].at(x, y) = Rgb(0.7f);
      for (Image& image : comparison.contenders[1].images) image.at(x, y) = Rgb(0.4f);
      comparison.reference.squared_error.at(x, y) = Rgb(0.02f, 0, 0.01f);
    }
  }
  const Rectangle left{"left", 0, 0, 0.5, 1};
  const std::vector<double> errors = region_errors(comparison, "noisy", left);
  EXPECT_NEAR(errors.at(0), 0.25 - 0.01, 1e-6);
  EXPECT_NEAR(errors.at(1), 0.49 - 0.01, 1e-6);
  EXPECT_NEAR(region_errors(comparison, "noisy", {"right", 0.5, 0, 1, 1}).at(0), 0, 1e-6);
  EXPECT_NEAR(region_ratio(comparison, "noisy", "clean", left).value, 0.36 / 0.15, 1e-5);
}

TEST(Regions, VariancesExcludeSharedErrors) {
  Comparison comparison;
  comparison.contenders.emplace_back().name = "dark";
  comparison.contenders[0].images.assign(3, Image(16, 16));
  const float levels[] = {0.1f, 0.2f, 0.6f};  // mean 0.3, variance 0.07
  for (size_t k = 0; k < 3; ++k) {
    for (Rgb& pixel : comparison.contenders[0].images[k].pixels) pixel = Rgb(levels[k]);
  }
  const std::vector<double> variances = region_variances(comparison, "dark", {"image"});
  ASSERT_EQ(variances.size(), 3u);
  EXPECT_NEAR(variances[0], 0.09 * 2 / 3, 1e-6);  // mean of the others is 0.4
  EXPECT_NEAR((variances[0] + variances[1] + variances[2]) / 3, 0.07, 1e-6);
}

TEST(Regions, BiasExcludesNoise) {
  Comparison comparison;
  comparison.reference.image = Image(16, 16);
  comparison.reference.squared_error = Image(16, 16);
  for (Rgb& pixel : comparison.reference.squared_error.pixels) pixel = Rgb(0.01f);
  comparison.contenders.emplace_back().name = "bright";
  const float noise[] = {-0.1f, 0.1f, 0.2f, -0.2f};
  for (const float n : noise) {
    Image& image = comparison.contenders[0].images.emplace_back(16, 16);
    for (int y = 0; y < 16; ++y) {
      for (int x = 0; x < 16; ++x) image.at(x, y) = Rgb(x < 8 ? 0.5f + (y % 2 == 0 ? n : -n) : 7.0f);
    }
  }
  // Products of different repetitions: each d is 0.5 ± n, so their mean is 0.25 − (Σn² / 12) = 0.25 − 0.1 / 12.
  const Rectangle left{"left", 0, 0, 0.5, 1};
  const Estimate bias2 = region_bias2(comparison, "bright", left);
  EXPECT_NEAR(bias2.value, 0.25 - 0.1 / 12 - 0.01, 1e-6);
  EXPECT_EQ(bias2.without.size(), 4u);
  const std::vector<double> means = region_means(comparison, "bright", left);
  ASSERT_EQ(means.size(), 4u);
  for (const double m : means) EXPECT_NEAR(m, 0.5, 1e-6);

  comparison.contenders[0].images.resize(2);  // their product is 0.25 − 0.01
  const Estimate of_two = region_bias2(comparison, "bright", left);
  EXPECT_NEAR(of_two.value, 0.24 - 0.01, 1e-6);
  EXPECT_TRUE(of_two.without.empty());
}

TEST(Regions, ContrastSurvivesNoiseButNotBlur) {
  const Image reference = quarter();
  Image noisy = reference;
  Image blurred = reference;
  Image halved = reference;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(-0.15f, 0.15f);
  for (size_t i = 0; i < noisy.pixels.size(); ++i) {
    noisy.pixels[i] += noise(random);
    blurred.pixels[i] = Rgb(0.35f);
    halved.pixels[i] = 0.5f * (reference.pixels[i] + Rgb(0.35f));
  }
  EXPECT_NEAR(contrast_kept(reference, reference, {"image"}), 1.0, 1e-9);
  EXPECT_NEAR(contrast_kept(halved, reference, {"image"}), 0.5, 1e-6);
  EXPECT_NEAR(contrast_kept(blurred, reference, {"image"}), 0.0, 1e-6);
  EXPECT_NEAR(contrast_kept(noisy, reference, {"image"}), 1.0, 0.05);  // five standard errors
  EXPECT_EQ(contrast_kept(noisy, blurred, {"image"}), 1);              // no contrast to keep
}

TEST(Regions, DetailSurvivesNoiseButNotBlur) {
  Image reference(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) reference.at(x, y) = Rgb((x / 2 + y / 2) % 2 == 0 ? 0.3f : 0.6f);
  }
  Image noisy = reference;
  Image blurred = reference;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> noise(-0.15f, 0.15f);
  for (Rgb& p : noisy.pixels) p += noise(random);
  for (int y = 0; y < 64; ++y) {
    for (int x = 1; x < 64; ++x) blurred.at(x, y) = 0.5f * (reference.at(x, y) + reference.at(x - 1, y));
  }
  EXPECT_NEAR(detail_kept(reference, reference, {"image"}), 1.0, 1e-9);
  EXPECT_NEAR(detail_kept(noisy, reference, {"image"}), 1.0, 0.05);  // five standard errors
  EXPECT_LT(detail_kept(blurred, reference, {"image"}), 0.7);
  EXPECT_EQ(detail_kept(noisy, Image(64, 64), {"image"}), 1);  // no detail to keep
}

}  // namespace
}  // namespace relume
