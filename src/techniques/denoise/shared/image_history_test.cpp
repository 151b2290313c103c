#include "techniques/denoise/shared/image_history.h"

#include "techniques/denoise/shared/converge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

namespace relume {
namespace {

constexpr uint32_t kWidth = 45;
constexpr uint32_t kHeight = 37;
constexpr uint32_t kPixels = kWidth * kHeight;

/// Buffers of constant images: 1 in this frame, 3 in the history.
struct Images {
  void average(bool still, float newest, bool tiles = false) {
    const std::vector<Rgb> unfiltered_before = unfiltered;
    ImageHistoryKernel kernel;
    kernel.shown = view_of(shown);
    kernel.before = view_of(before);
    kernel.motion = view_of(motion);
    kernel.albedo = view_of(albedo);
    kernel.emission = view_of(emission);
    kernel.edge_rays = view_of(edge_rays);
    kernel.unfiltered_before = view_of(unfiltered_before);
    kernel.unfiltered = mutable_view_of(unfiltered);
    kernel.image = mutable_view_of(image);
    kernel.specular = specular;
    kernel.samples = view_of(samples);
    kernel.newest = newest;
    kernel.filtered_share = mutable_view_of(filtered_share);
    kernel.frames = frames;
    kernel.averaged = averaged > 0 ? averaged : frames;
    kernel.still = still;
    kernel.width = kWidth;
    kernel.height = kHeight;
    for (uint32_t y = 0; y < kHeight; y += tiles ? kTileSize : 1) {
      for (uint32_t x = 0; x < kWidth; x += tiles ? kTileSize : 1) {
        if (tiles) {
          kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
        } else {
          kernel(x, y);
        }
      }
    }
  }
  ConvergeKernel converge() {
    return {view_of(before), view_of(shown), view_of(m2), view_of(samples), mutable_view_of(image),
            false,           true,           kWidth,      kHeight};
  }

  SpecularImages specular;
  std::vector<Rgb> shown = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<Rgb> before = std::vector<Rgb>(kPixels, Rgb(3));
  std::vector<Rgb> image = std::vector<Rgb>(kPixels);
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> emission = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<uint32_t> edge_rays = std::vector<uint32_t>(kPixels, 0);
  std::vector<Rgb> unfiltered = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<float> filtered_share = std::vector<float>(kPixels, 1.0f);
  uint32_t frames = 1;
  uint32_t averaged = 0;  ///< 0: all frames
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels, Vec2(0));
  std::vector<float> m2 = std::vector<float>(kPixels, 0.0f);
  std::vector<uint32_t> samples = std::vector<uint32_t>(kPixels, 16);
};

/// A step of light on the surface at rest, and another in its reflection, which moves by four pixels.
TEST(ImageHistory, PartsMoveByTheirOwnMotion) {
  Images p;
  std::vector<Rgb> reflected(kPixels);
  std::vector<Rgb> reflected_before(kPixels);
  std::vector<Rgb> result(kPixels);
  const std::vector<Vec2> motion(kPixels, Vec2(4, 0));
  for (uint32_t i = 0; i < kPixels; ++i) {
    const uint32_t x = i % kWidth;
    reflected[i] = Rgb(x < 24 ? 2.0f : 0.0f);
    reflected_before[i] = Rgb(x < 20 ? 2.0f : 0.0f);
    p.shown[i] = Rgb(x < 10 ? 1.0f : 3.0f) + reflected[i];
    p.before[i] = Rgb(x < 10 ? 1.0f : 3.0f) + reflected_before[i];
  }
  p.specular = {view_of(reflected), view_of(reflected_before), view_of(motion), mutable_view_of(result)};
  p.average(false, 0.2f);
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 5; x < kWidth; ++x) {
      EXPECT_EQ(p.image[y * kWidth + x], p.shown[y * kWidth + x]) << x;
      EXPECT_EQ(result[y * kWidth + x], reflected[y * kWidth + x]) << x;
    }
  }
  p.frames = 7;
  p.average(true, 0.2f);  // at rest, averaged like the image: weight 1/4
  EXPECT_EQ(result[21], Rgb(0.5f));
}

/// Random images with random motion by row: mostly a fraction of a pixel that grows with y; none; different in each
/// pixel; or out of the image. Some pixels are lamps, and some are edges of lamps. Three of five have just come into
/// view.
struct MovingImages : Images {
  explicit MovingImages(bool apart) {
    std::mt19937 generator(7);
    std::uniform_real_distribution<float> uniform(0, 2);
    const auto color = [&] { return Rgb(uniform(generator), uniform(generator), uniform(generator)); };
    for (uint32_t i = 0; i < kPixels; ++i) {
      const uint32_t x = i % kWidth;
      const uint32_t y = i / kWidth;
      shown[i] = color();
      before[i] = color();
      emission[i] = 0.1f * color();
      unfiltered[i] = 0.1f * color();
      filtered_share[i] = x % 3 == 0 ? 0.0f : 0.5f * uniform(generator);
      if (x % 13 == 0) albedo[i] = Rgb(0);
      if (x % 19 == 0 && y % 3 == 0) edge_rays[i] = 8;
      motion[i] = Vec2(0.3f * static_cast<float>(y), 0.01f * static_cast<float>(x));
      if (y % 8 == 7) motion[i] = Vec2(4 * uniform(generator) - 4, uniform(generator));
      if (y % 8 == 6) motion[i] = Vec2(0);
      if (y == 20) motion[i] = Vec2(65504);
      reflected[i] = 0.3f * color();
      reflected_before[i] = 0.3f * color();
      reflected_motion[i] = 0.5f * motion[i];
      samples[i] = uniform(generator) < 1.2f ? 1 : 2;
      reflected_samples[i] = uniform(generator) < 1.2f ? 1 : 2;
    }
    if (apart) {
      specular = {view_of(reflected), view_of(reflected_before), view_of(reflected_motion), mutable_view_of(result),
                  view_of(reflected_samples)};
    }
  }

  std::vector<Rgb> reflected = std::vector<Rgb>(kPixels);
  std::vector<Rgb> reflected_before = reflected;
  std::vector<Vec2> reflected_motion = std::vector<Vec2>(kPixels);
  std::vector<uint32_t> reflected_samples = std::vector<uint32_t>(kPixels);
  std::vector<Rgb> result = reflected;
};

TEST(ImageHistory, TilesAverageLikeSinglePixels) {
  for (const bool apart : {false, true}) {
    for (const auto& [still, newest] : {std::pair(true, 0.2f), std::pair(false, 0.2f), std::pair(false, 1.0f)}) {
      SCOPED_TRACE(::testing::Message() << "apart " << apart << ", still " << still << ", newest " << newest);
      MovingImages single(apart);
      MovingImages tiles(apart);
      single.frames = tiles.frames = 7;
      single.averaged = tiles.averaged = 5;
      single.average(still, newest);
      tiles.average(still, newest, true);
      EXPECT_EQ(single.image, tiles.image);
      EXPECT_EQ(single.unfiltered, tiles.unfiltered);
      EXPECT_EQ(single.filtered_share, tiles.filtered_share);
      EXPECT_EQ(single.result, tiles.result);
    }
  }
}

TEST(ImageHistory, LaterImagesWeighMore) {
  Images p;
  p.frames = 7;
  p.average(true, 0.2f);
  EXPECT_EQ(p.image[7], Rgb(2.5f));  // weight 1/4
}

TEST(ImageHistory, ImagesCountFromTheFirstCompleteOne) {
  Images p;
  p.frames = 5;
  p.averaged = 1;
  p.unfiltered[8] = Rgb(1);
  p.emission[8] = Rgb(0.5f);
  p.average(true, 0.2f);
  EXPECT_EQ(p.image[7], Rgb(1)) << "earlier images lack samples";
  EXPECT_EQ(p.unfiltered[8], Rgb(0.9f)) << "emission averages over all frames";
}

TEST(ImageHistory, UnfilteredLightCountsEquallyInEveryFrame) {
  // In every third of twelve frames, pixel 0 shows a lamp, pixel 1 the same lamp on a filtered surface, pixel 2 a sky
  // as bright as the wall. Filtered light grows by one per frame, except at pixel 2.
  Images p;
  const double parts[] = {1, 2, 4, 5, 7, 8, 10, 11};
  double sum_of_wall = 0;
  for (int k = 0; k < 8; ++k) sum_of_wall += (k + 1) * parts[k] / 36;
  double sum_of_all = 0;
  for (int i = 0; i < 12; ++i) {
    const bool lamp = i % 3 == 0;
    const Rgb part(static_cast<float>(i));
    p.albedo[0] = p.albedo[2] = Rgb(lamp ? 0.0f : 0.5f);
    p.shown[0] = lamp ? Rgb(30) : part;
    p.emission[1] = Rgb(lamp ? 30.0f : 0.0f);
    p.shown[1] = part + p.emission[1];
    p.shown[2] = Rgb(3);
    p.frames = static_cast<uint32_t>(i + 1);
    p.average(i > 0, i > 0 ? 0.2f : 1.0f);
    sum_of_all += (i + 1) * i / 78.0;
    p.before = p.image;
    EXPECT_NEAR(p.image[2].r, 3, 1e-4) << i;
  }
  EXPECT_NEAR(p.image[0].r, 10 + sum_of_wall * 2 / 3, 1e-4);
  EXPECT_NEAR(p.image[1].r, 10 + sum_of_all, 1e-4);
}

/// The measured emission at a lamp's edge varies between frames. None of it is scattered light.
TEST(ImageHistory, MovedImagesKeepScatteredLightOnly) {
  Images p;
  std::fill(p.edge_rays.begin(), p.edge_rays.end(), 16u);
  for (int i = 0; i < 5; ++i) {
    const Rgb emission(i % 2 == 0 ? 8.0f : 12.0f);
    std::fill(p.emission.begin(), p.emission.end(), emission);
    std::fill(p.shown.begin(), p.shown.end(), emission + Rgb(2));
    p.frames = static_cast<uint32_t>(i % 4 + 1);
    const bool still = i > 0 && i < 4;
    p.average(still, i > 0 ? 0.2f : 1.0f);
    if (i == 3) {
      EXPECT_NEAR(p.image[7].r, 12, 1e-5);  // the mean of both
    }
    p.before = p.image;
  }
  EXPECT_NEAR(p.image[7].r, 8 + 2, 1e-5);
}

TEST(ImageHistory, IsNeverNegativeIfSamplesMissAVisibleLamp) {
  Images p;
  for (int i = 0; i < 4; ++i) {
    const bool lamp = i > 0;  // at its edge in a mirror: features then show it, and samples miss it
    p.emission[0] = Rgb(lamp ? 18.0f : 0.0f);
    p.shown[0] = Rgb(lamp ? 0.0f : 5.0f);
    p.frames = static_cast<uint32_t>(i + 1);
    p.average(i > 0, i > 0 ? 0.2f : 1.0f);
    p.before = p.image;
    EXPECT_GE(p.image[0].r, 0) << i;
  }
  EXPECT_EQ(p.image[0], Rgb(0));
}

TEST(ImageHistory, MovedImagesAreClampedToTheirNeighbourhood) {
  Images p;
  p.average(false, 0.25f);
  EXPECT_EQ(p.image[7], Rgb(1));  // 3 exceeds the range around
}

/// A bright wall with a dark window in every third pixel of every third row.
struct Facade : Images {
  Facade() {
    for (uint32_t i = 0; i < kPixels; ++i) {
      if (is_window(i % kWidth, i / kWidth)) shown[i] = Rgb(0);
    }
  }
  static bool is_window(uint32_t x, uint32_t y) { return x % 3 == 1 && y % 3 == 1; }
};

/// A dark object has moved away. Its image, clamped, would make every pixel as dark as the window next to it.
TEST(ImageHistory, WindowsThatComeIntoViewAreNoDots) {
  Facade p;
  p.before.assign(kPixels, Rgb(0));
  p.samples.assign(kPixels, 1);
  p.average(false, 0.2f);
  double sum = 0;
  for (uint32_t y = 3; y < 33; ++y) {
    for (uint32_t x = 3; x < 33; ++x) {
      const float value = p.image[y * kWidth + x].r;
      EXPECT_GE(value, 0.59f) << x << " " << y;  // 0.8 · 0.75 in a window
      sum += value;
    }
  }
  EXPECT_NEAR(sum / 900, 8.0 / 9, 1e-5) << "smoothing keeps the mean";
}

TEST(ImageHistory, WhatComesIntoTheImageIsSmoothed) {
  Facade p;
  std::fill_n(p.motion.begin(), 10 * kWidth, Vec2(0, 20));
  p.average(false, 0.2f);
  EXPECT_NEAR(p.image[4 * kWidth + 4].r, 0.6f, 1e-6f);
  EXPECT_NEAR(p.image[4 * kWidth + 3].r, 0.2f + 0.8f * 0.875f, 1e-6f);
  EXPECT_NEAR(p.image[13 * kWidth + 13].r, 0.8f, 1e-6f) << "the history, clamped to the wall";
}

TEST(ImageHistory, LampsDoNotSpreadOverWhatComesIntoView) {
  Images p;
  p.samples.assign(kPixels, 1);
  const uint32_t lamp = 10 * kWidth + 10;
  p.albedo[lamp] = Rgb(0);
  p.shown[lamp] = Rgb(1000);
  p.average(false, 0.2f);
  EXPECT_NEAR(p.image[lamp].r, 1000, 1e-3);
  EXPECT_NEAR(p.image[lamp + 1].r, p.image[lamp + 5].r, 1e-6f);
  EXPECT_NEAR(p.image[lamp + kWidth - 1].r, p.image[lamp + 5].r, 1e-6f);
}

TEST(ImageHistory, LoneNewSurfacesKeepTheHistoryOfTheImage) {
  Facade p;
  p.before.assign(kPixels, Rgb(0.5f));
  for (uint32_t i = 0; i < kPixels; ++i) p.samples[i] = Facade::is_window(i % kWidth, i / kWidth) ? 1 : 16;
  p.average(false, 0.2f);
  EXPECT_NEAR(p.image[4 * kWidth + 4].r, 0.8f * 0.5f, 1e-6f);
}

TEST(ImageHistory, MotionIsFollowedWithoutBlur) {
  Images p;
  const auto wave = [](float x) { return Rgb(2.0f + std::sin(0.5f * x)); };
  for (uint32_t i = 0; i < kPixels; ++i) {
    const auto x = static_cast<float>(i % kWidth);
    p.before[i] = wave(x);
    p.motion[i] = Vec2(2.5f, 0);
    p.shown[i] = Rgb(i % 2 == 0 ? 0.0f : 4.0f);  // clamps nothing
  }
  p.average(false, 1e-6f);
  for (uint32_t x = 6; x < kWidth - 6; ++x)
    EXPECT_NEAR(p.image[20 * kWidth + x].r, wave(static_cast<float>(x) - 2.5f).r, 0.01f);
}

TEST(ImageHistory, ConvergesToTheMeanWithinItsError) {
  Images p;  // the image is off by 2
  const ConvergeKernel kernel = p.converge();
  kernel(20, 20);
  EXPECT_EQ(p.image[20 * kWidth + 20], Rgb(1));
  p.m2.assign(kPixels, 2.0f * 16 * 15);  // half of the squared difference, as variance of the mean
  kernel(20, 20);
  EXPECT_NEAR(p.image[20 * kWidth + 20].r, 2.0f, 1e-5f);
  p.m2.assign(kPixels, 9.0f * 16 * 15);
  kernel(20, 20);
  EXPECT_EQ(p.image[20 * kWidth + 20], Rgb(3));
  p.m2.assign(kPixels, 0.0f);
  p.samples.assign(kPixels, 2);  // too few for a variance
  kernel(20, 20);
  EXPECT_EQ(p.image[20 * kWidth + 20], Rgb(3));
}

TEST(ImageHistory, CorrelatedFramesRaiseTheErrorOfTheMean) {
  Images p;
  std::fill(p.m2.begin(), p.m2.end(), 16.0f * 15.0f);  // the mean of 16 samples has variance 1, and differs by 2
  for (const auto& [correlated, expected] : {std::pair(1.0f, 1.5f), std::pair(2.0f, 2.0f), std::pair(100.0f, 3.0f)}) {
    ConvergeKernel kernel = p.converge();
    kernel.correlated_frames = correlated;
    kernel(20, 10);
    EXPECT_NEAR(p.image[10 * kWidth + 20].r, expected, 1e-5f) << correlated;
    kernel(Tile{0, 0, kTileSize, kTileSize});
    EXPECT_NEAR(p.image[10 * kWidth + 10].r, expected, 1e-5f) << correlated;
  }
}

TEST(ImageHistory, ALonelyBrightSampleStaysFiltered) {
  Images p;  // black except one sample of 160 in one pixel
  constexpr uint32_t kPixel = 20 * kWidth + 20;
  p.before.assign(kPixels, Rgb(0));
  p.shown.assign(kPixels, Rgb(0));
  p.shown[kPixel] = Rgb(10);
  p.m2[kPixel] = 160.0f * 160 * (1 - 1 / 16.0f);
  ConvergeKernel kernel = p.converge();
  kernel.stratified = true;
  kernel(20, 20);
  EXPECT_NEAR(p.image[kPixel].r, 0.0f, 1e-3f);
}

TEST(ImageHistory, TilesConvergeLikeSinglePixels) {
  Images p;
  std::mt19937 generator(1);
  std::uniform_real_distribution<float> uniform(0, 2);
  for (uint32_t i = 0; i < kPixels; ++i) {
    p.shown[i] = Rgb(uniform(generator), uniform(generator), 1);
    p.before[i] = Rgb(1);
    p.m2[i] = 40.0f * uniform(generator);
    p.samples[i] = i % 40 + 2;
  }
  ConvergeKernel kernel = p.converge();
  kernel.stratified = true;
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
  }
  const std::vector<Rgb> single = p.image;
  for (uint32_t y = 0; y < kHeight; y += kTileSize) {
    for (uint32_t x = 0; x < kWidth; x += kTileSize)
      kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
  }
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits
  EXPECT_EQ(std::memcmp(single.data(), p.image.data(), kPixels * sizeof(Rgb)), 0);
}

}  // namespace
}  // namespace relume
