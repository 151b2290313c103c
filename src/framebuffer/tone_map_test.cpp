#include "framebuffer/tone_map.h"

#include <cmath>

#include <gtest/gtest.h>

namespace relume {
namespace {

constexpr ToneMap kAll[] = {ToneMap::none, ToneMap::reinhard, ToneMap::aces, ToneMap::agx, ToneMap::neutral};

TEST(ToneMap, BlackStaysBlack) {
  // AgX's lowest encoded value is 2^-12.5 of white, where its curve is clamped at 0.
  for (const ToneMap curve : kAll)
    EXPECT_EQ(tone_map(curve, 0.0f, Rgb(0)), Rgb(0)) << kToneMapNames[static_cast<size_t>(curve)];
}

TEST(ToneMap, BrightBecomesWhite) {
  // Reinhard's curve only approaches 1. The published AgX polynomial ends at 0.9986, before exponent 2.2.
  for (const ToneMap curve : kAll) {
    const Rgb white = tone_map(curve, 0.0f, Rgb(1e6f));
    for (int c = 0; c < 3; ++c) {
      EXPECT_GT(white[c], 0.995f);
      EXPECT_LE(white[c], 1.0f);
    }
  }
}

TEST(ToneMap, RisesWithExposureAndStaysInRange) {
  const Rgb colors[] = {Rgb(0.18f), {0.9f, 0.5f, 0.1f}, {0.05f, 0.3f, 0.8f}};
  for (const ToneMap curve : kAll) {
    for (const Rgb& color : colors) {
      float previous = -1.0f;
      for (float exposure = -14.0f; exposure <= 14.0f; exposure += 0.125f) {
        const Rgb shown = tone_map(curve, exposure, color);
        for (int c = 0; c < 3; ++c) {
          ASSERT_GE(shown[c], 0.0f);
          ASSERT_LE(shown[c], 1.0f);
        }
        // Compares luminance because path-to-white may lower a single channel; the AgX polynomial has an error of 2e-3.
        ASSERT_GE(luminance(shown), previous - 1e-4f) << kToneMapNames[static_cast<size_t>(curve)] << ' ' << exposure;
        previous = luminance(shown);
      }
    }
  }
}

TEST(ToneMap, GreyStaysGrey) {
  // Rows of the published matrices sum to 1 within 1.5e-4; the curve's slope and the exponent amplify the difference.
  for (const ToneMap curve : kAll) {
    for (const float x : {0.01f, 0.18f, 0.5f, 1.0f, 4.0f}) {
      const Rgb grey = tone_map(curve, 0.0f, Rgb(x));
      EXPECT_NEAR(grey.r, grey.g, 1e-3f * grey.g);
      EXPECT_NEAR(grey.b, grey.g, 1e-3f * grey.g);
    }
  }
}

TEST(ToneMap, ExposureIsInStops) {
  for (const ToneMap curve : kAll) {
    const Rgb a = tone_map(curve, 2.0f, Rgb(0.1f, 0.2f, 0.05f));
    EXPECT_EQ(a, tone_map(curve, 0.0f, Rgb(0.4f, 0.8f, 0.2f)));
  }
}

TEST(ToneMap, MatchesThePublishedFormulas) {
  EXPECT_NEAR(tone_map(ToneMap::reinhard, 0.0f, Rgb(3.0f)).g, 0.75f, 1e-6f);  // L / (1 + L)
  EXPECT_EQ(tone_map(ToneMap::none, 0.0f, Rgb(0.3f, 2.0f, -1.0f)), Rgb(0.3f, 1.0f, 0.0f));
  // Hill's matrices preserve grey, so only the rational fit acts.
  for (const double v : {0.02, 0.18, 1.0, 5.0}) {
    const double fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    EXPECT_NEAR(tone_map(ToneMap::aces, 0.0f, Rgb(static_cast<float>(v))).g, fit, 2e-4);  // rows sum to 1 within 1e-5
  }
  // Red through Hill's matrices by hand: first column of the input matrix, fit, output matrix.
  const auto fit = [](double v) {
    return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  };
  const double r = fit(0.59719), g = fit(0.07600), b = fit(0.02840);
  const Rgb red = tone_map(ToneMap::aces, 0.0f, Rgb(1, 0, 0));
  EXPECT_NEAR(red.r, 1.60475 * r - 0.53108 * g - 0.07367 * b, 1e-5);
  EXPECT_NEAR(red.g, std::max(0.0, -0.10208 * r + 1.10813 * g - 0.00605 * b), 1e-5);
  EXPECT_NEAR(red.b, std::max(0.0, -0.00327 * r - 0.07276 * g + 1.07602 * b), 1e-5);
}

TEST(ToneMap, NeutralKeepsBaseColors) {
  // A surface in white light reflects 4 % more than its base colour, which [Khronos24] subtracts.
  for (const Rgb& base : {Rgb(0.1f, 0.5f, 0.3f), Rgb(0.75f), Rgb(0.6f, 0.08f, 0.2f)}) {
    const Rgb shown = tone_map(ToneMap::neutral, 0.0f, base + Rgb(0.04f));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(shown[c], base[c], 1e-6f);
  }
  // By hand: peak 3 - 0.04 = 2.96, compressed to 1 - 0.24² / (2.96 + 0.24 - 0.76).
  const double compressed = 1 - 0.24 * 0.24 / (2.96 + 0.24 - 0.76);
  const double white = 1 - 1 / (0.15 * (2.96 - compressed) + 1);
  const Rgb red = tone_map(ToneMap::neutral, 0.0f, Rgb(3, 0.54f, 0.04f + 0.04f));
  EXPECT_NEAR(red.r, compressed, 1e-5);
  EXPECT_NEAR(red.g, 0.5 * compressed / 2.96 * (1 - white) + compressed * white, 1e-5);
}

TEST(ToneMap, AgxPutsMiddleGreyOnItsPivot) {
  // The encoding maps 0.18 to (log2 0.18 + 12.47393) / 16.5 = 20/33, the pivot of AgX's curve, with display value 0.5.
  // The polynomial fit has a root mean square error of 2e-3, locally up to 0.01.
  const Rgb grey = tone_map(ToneMap::agx, 0.0f, Rgb(0.18f));
  EXPECT_NEAR(std::pow(grey.g, 1.0f / 2.2f), 0.5f, 0.01f);
}

TEST(ToneMap, NonFiniteAndNegativeInputIsShownAsBlackOrWhite) {
  for (const ToneMap curve : kAll) {
    EXPECT_EQ(tone_map(curve, 0.0f, Rgb(std::nanf(""))), Rgb(0));
    EXPECT_EQ(tone_map(curve, 0.0f, Rgb(-3.0f)), Rgb(0));
    EXPECT_GT(tone_map(curve, 0.0f, Rgb(kInfinity)).g, 0.995f);
    EXPECT_GT(tone_map(curve, 100.0f, Rgb(1e38f)).g, 0.995f);
  }
}

TEST(ToneMap, ImagesAreMappedPixelByPixel) {
  Image image(70, 90);
  for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = Rgb(0.001f * static_cast<float>(i), 0.2f, 1.0f);
  const Image mapped = tone_map(image, ToneMap::agx, 1.0f);
  for (size_t i = 0; i < image.pixels.size(); i += 17)
    EXPECT_EQ(mapped.pixels[i], tone_map(ToneMap::agx, 1.0f, image.pixels[i]));
}

}  // namespace
}  // namespace relume
