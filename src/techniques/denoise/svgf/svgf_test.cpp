#include "techniques/denoise/svgf/svgf.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "techniques/denoise/svgf/testing/wall.h"

namespace relume {
namespace {

using testing::Wall;

constexpr uint32_t kWidth = Wall::kWidth;
constexpr uint32_t kHeight = Wall::kHeight;
constexpr uint32_t kPixels = Wall::kPixels;

TEST(Svgf, LanesMatchSinglePixels) {
  Wall wall;
  wall.make_noise(6);
  for (uint32_t i = 0; i < kPixels; ++i) {
    wall.normal[i] = glm::normalize(Vec3(0.1f * std::sin(0.3f * static_cast<float>(i)), 0, 1));
    if (i % 11 == 0 || i / kWidth == 7) wall.albedo[i] = Rgb(0);
  }
  wall.prepare();
  for (const uint32_t step : {1u, 4u, 16u}) {
    const AtrousKernel kernel = wall.level(step);
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
    }
    const std::vector<float> single = wall.filtered;
    std::fill(wall.filtered.begin(), wall.filtered.end(), -1.0f);
    for (uint32_t y = 0; y < kHeight; y += kTileSize) {
      for (uint32_t x = 0; x < kWidth; x += kTileSize)
        kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
    }
    for (uint32_t c = 0; c < kAtrousChannels; ++c) {
      for (uint32_t y = 0; y < kHeight; ++y) {
        const float* lanes = wall.level(step).filtered.at(c, 0, y);
        const float* alone = single.data() + (lanes - wall.filtered.data());
        // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits
        ASSERT_EQ(std::memcmp(lanes, alone, kWidth * sizeof(float)), 0) << step << " " << c << " " << y;
      }
    }
  }
}

TEST(Svgf, CopiesPixelsThatItDoesNotFilter) {
  Wall wall;
  wall.make_noise(6);
  const auto is_black = [](uint32_t x, uint32_t y) { return y == 7 || (x == 20 && y == 9); };
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (is_black(i % kWidth, i / kWidth)) wall.albedo[i] = Rgb(0);
  }
  wall.prepare();
  wall.level(1)(Tile{0, 0, kWidth, kHeight});
  for (uint32_t c = 0; c < kAtrousChannels; ++c) {
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) {
        const bool is_copied = *wall.image(wall.filtered).at(c, x, y) == wall.at(c, x, y);
        ASSERT_EQ(is_copied, is_black(x, y)) << c << " " << x << " " << y;
      }
    }
  }
}

TEST(Svgf, PreparesLanesLikeSinglePixels) {
  Wall wall;
  wall.make_noise(6);
  for (uint32_t i = 0; i < kPixels; ++i) {
    wall.position[i].z = 0.01f * static_cast<float>(i % 13);
    wall.depth[i] = 1.0f + 0.1f * static_cast<float>(i % 7);
    wall.count[i] = i % 97 < 3 ? i % 4 : 4 + i % 5;  // some are young
    if (i % 5 == 0) wall.normal[i] = Vec3(1, 0, 0);
    if (i / kWidth > 20) wall.count[i] = i % 2;                 // no sample or one
    if (i / kWidth > 30 && i % kWidth < 24) wall.count[i] = 0;  // more than the reach without samples
    wall.light[i] *= Rgb(1, 2, 3);
    if (i % 11 == 0) wall.albedo[i] = Rgb(0);
    if (i % 17 == 0) wall.albedo[i] = Rgb(0, 0.5f * kLeastAlbedo, kLeastAlbedo);
    if (i / kWidth == 12) wall.albedo[i] = Rgb(0);
  }
  const std::vector<float> unwritten(wall.features.size(), -7.0f);
  wall.features = unwritten;
  std::copy_n(unwritten.begin(), wall.planes.size(), wall.planes.begin());
  wall.prepare();
  const std::vector<float> features = std::exchange(wall.features, unwritten);
  const std::vector<float> planes = wall.planes;
  std::copy_n(unwritten.begin(), wall.planes.size(), wall.planes.begin());
  const SvgfPrepareKernel kernel = wall.prepare_kernel();
  for (uint32_t y = 0; y < kHeight; y += kTileSize) {
    for (uint32_t x = 0; x < kWidth; x += kTileSize)
      kernel(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
  }
  EXPECT_EQ(wall.features, features);
  EXPECT_EQ(wall.planes, planes);
}

/// Samples and histories of a wall that moves by `by` pixels per frame. In parts of it, the surface changes, is
/// background, or has no samples. One corner is black, and was before.
struct MovingWall {
  explicit MovingWall(const Vec2& by) : motion(kPixels, by) {
    std::mt19937 generator(5);
    std::uniform_real_distribution<float> uniform(0, 2);
    for (uint32_t i = 0; i < kPixels; ++i) {
      scattered[i] = Rgb(uniform(generator), uniform(generator), uniform(generator));
      light_before[i] = Rgb(uniform(generator), uniform(generator), uniform(generator));
      moments_before[i] = Vec2(uniform(generator), uniform(generator));
      count_before[i] = 1 + i % 9;
      const uint32_t x = i % kWidth;
      const uint32_t y = i / kWidth;
      if (x % 11 == 0) albedo[i] = Rgb(0);
      if (x % 17 == 0) albedo[i] = Rgb(0, 0.5f, 0.5f * kLeastAlbedo);
      if (x % 23 == 0) scattered[i].g = std::numeric_limits<float>::infinity();
      if (y % 9 == 4 && x > 30) count_before[i] = 0;
      if (y % 9 == 5 && x % 16 == 3) count_before[i] = 0;
      if (y > 30 && x > 40) surface[i] = kNoSurface;
      if (y > 30 && x > 41) surface_before[i] = kNoSurface;
      if (y % 9 == 2 && x % 16 == 12) surface_before[i] = 3;
      if (y % 9 == 7 && x % 16 == 5) normal_before[i] = Vec3(1, 0, 0);
      if (y % 9 == 8 && x % 16 == 5) position_before[i].z = 1;
      if (y % 9 == 6) motion[i] += Vec2(uniform(generator), 0);
      if (is_unlit(x, y)) {
        albedo[i] = Rgb(0);
        count_before[i] = 0;
        motion[i] = by;
      }
    }
  }

  static bool is_unlit(uint32_t x, uint32_t y) { return x > 50 && y < 22; }

  SvgfAccumulateKernel kernel() {
    SvgfAccumulateKernel kernel;
    kernel.history = {
        .reprojection = {view_of(motion), view_of(position), view_of(normal), view_of(depth), view_of(surface),
                         view_of(position_before), view_of(normal_before), view_of(surface_before), kWidth, kHeight},
        .samples = {view_of(scattered), view_of(scattered), view_of(allocation), view_of(albedo), {}},
        .light_before = view_of(light_before),
        .count_before = view_of(count_before),
        .light = mutable_view_of(light),
        .count = mutable_view_of(count),
        .max_samples = 7,
        .discounts = {},
        .lambdas = view_of(lambdas)};
    kernel.moments_before = view_of(moments_before);
    kernel.moments = mutable_view_of(moments);
    return kernel;
  }

  std::vector<Vec2> motion;
  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> position_before = position;
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<Vec3> normal_before = normal;
  std::vector<float> depth = std::vector<float>(kPixels, 1.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels, 2);
  std::vector<uint32_t> surface_before = surface;
  std::vector<uint32_t> allocation;
  std::vector<float> lambdas;
  std::vector<Rgb> scattered = std::vector<Rgb>(kPixels);
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> light_before = scattered;
  std::vector<Vec2> moments_before = std::vector<Vec2>(kPixels);
  std::vector<uint32_t> count_before = std::vector<uint32_t>(kPixels);
  std::vector<Rgb> light = scattered;
  std::vector<Vec2> moments = moments_before;
  std::vector<uint32_t> count = count_before;
};

TEST(Svgf, AccumulatesLanesLikeSinglePixels) {
  for (const Vec2& motion :
       {Vec2(0), Vec2(3, -2), Vec2(-0.25f, 0), Vec2(1.3f, 2.6f), Vec2(-0.7f, 0.3f), Vec2(-65504)}) {
    for (const bool sparse : {false, true}) {
      SCOPED_TRACE(::testing::Message() << motion.x << " " << motion.y << (sparse ? ", half of the pixels" : ""));
      MovingWall single(motion);
      for (uint32_t i = 0; sparse && i < kPixels; ++i) {
        single.allocation.push_back(i % 2);
        single.lambdas.push_back(0.25f * static_cast<float>(i % 5));
      }
      MovingWall tiles = single;
      const SvgfAccumulateKernel one = single.kernel();
      const SvgfAccumulateKernel many = tiles.kernel();
      for (uint32_t y = 0; y < kHeight; ++y) {
        for (uint32_t x = 0; x < kWidth; ++x) one(x, y);
      }
      for (uint32_t y = 0; y < kHeight; y += kTileSize) {
        for (uint32_t x = 0; x < kWidth; x += kTileSize)
          many(Tile{x, y, std::min(x + kTileSize, kWidth), std::min(y + kTileSize, kHeight)});
      }
      EXPECT_EQ(single.light, tiles.light);
      EXPECT_EQ(single.moments, tiles.moments);
      EXPECT_EQ(single.count, tiles.count);
      RowHistory row;
      EXPECT_EQ(many.history.accumulate(32, 18, row), std::fabs(motion.x) < 4) << "a row on the wall";
      EXPECT_TRUE(many.history.accumulate(64, 8, row)) << "a row without light";
      EXPECT_EQ(tiles.count[8 * kWidth + 64], 0u);
    }
  }
}

TEST(Svgf, KeepsAConstant) {
  Wall wall;
  wall.moments.assign(kPixels, Vec2(1, 4));  // as if there were noise
  wall.filter();
  for (uint32_t i = 0; i < kPixels; ++i) {
    for (uint32_t c = 0; c < 3; ++c)
      ASSERT_NEAR(wall.at(c, i % kWidth, i / kWidth), static_cast<float>(c + 1), 1e-5f) << i;
  }
}

TEST(Svgf, RemovesNoiseByItsVariance) {
  Wall wall;
  wall.make_noise(8);
  wall.prepare();
  EXPECT_NEAR(wall.mse(1), 1.0 / 8, 0.02);
  wall.filter();
  EXPECT_LT(wall.mse(1), 0.1 / 8);
}

TEST(Svgf, CorrelatedFramesRaiseTheVarianceOfTheMean) {
  Wall wall;
  wall.make_noise(8);
  wall.prepare();
  const float independent = wall.at(kAtrousVariance, 20, 20);
  EXPECT_GT(independent, 0);
  for (const auto& [correlated, factor] : {std::pair(3.0f, 3.0f), std::pair(41.0f, 8.0f)}) {
    SvgfPrepareKernel kernel = wall.prepare_kernel();
    kernel.correlated_frames = correlated;
    kernel(20, 20);
    EXPECT_FLOAT_EQ(wall.at(kAtrousVariance, 20, 20), factor * independent);
    kernel(Tile{16, 16, 32, 32});
    EXPECT_FLOAT_EQ(wall.at(kAtrousVariance, 20, 20), factor * independent);
  }
}

TEST(Svgf, ShortHistoriesUseTheirNeighbours) {
  Wall wall;
  wall.make_noise(1);
  wall.filter();
  EXPECT_LT(wall.mse(1), 0.1);
}

TEST(Svgf, KeepsEdgesOfLightWithoutNoise) {
  Wall wall;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const float value = i % kWidth < 40 ? 1.0f : 2.0f;  // a shadow's edge
    wall.light[i] = Rgb(value);
    wall.moments[i] = Vec2(value, value * value);
  }
  wall.filter();
  EXPECT_NEAR(wall.at(0, 39, 20), 1.0f, 1e-3f);
  EXPECT_NEAR(wall.at(0, 40, 20), 2.0f, 1e-3f);
}

TEST(Svgf, StopsAtNormalsAndPlanes) {
  for (const bool turn : {true, false}) {
    Wall wall;
    wall.moments.assign(kPixels, Vec2(0, 1e4f));  // noise above any contrast
    for (uint32_t i = 0; i < kPixels; ++i) {
      const bool right = i % kWidth >= 40;
      wall.light[i] = Rgb(right ? 2.0f : 1.0f);
      if (right && turn) wall.normal[i] = Vec3(1, 0, 0);
      if (right && !turn) wall.position[i].z += 1.0f;
    }
    wall.filter();
    EXPECT_NEAR(wall.at(0, 39, 20), 1.0f, 2e-3f);
    EXPECT_NEAR(wall.at(0, 40, 20), 2.0f, 2e-3f);
  }
}

TEST(Svgf, PixelsWithoutSamplesUseTheirNeighbours) {
  Wall wall;
  for (uint32_t i = 0; i < kPixels; i += 2) {
    wall.count[i] = 0;
    wall.light[i] = Rgb(0);
  }
  wall.filter();
  for (uint32_t i = 0; i < kPixels; ++i) ASSERT_NEAR(wall.at(1, i % kWidth, i / kWidth), 2.0f, 1e-4f) << i;
}

TEST(Svgf, PixelsWithoutSamplesThatAreAloneOnTheirPlaneUseAllNeighbours) {
  Wall wall;
  const uint32_t alone = 20 * kWidth + 30;
  wall.normal[alone] = Vec3(1, 0, 0);
  wall.count[alone] = 0;
  wall.light[alone] = Rgb(0);
  wall.filter();
  EXPECT_NEAR(wall.at(1, 30, 20), 2.0f, 1e-4f);
}

TEST(Svgf, UnfilteredPixelsDoNotLeak) {
  Wall wall;
  wall.moments.assign(kPixels, Vec2(1, 100));
  for (uint32_t i = 0; i < kPixels; i += 5) {
    wall.albedo[i] = Rgb(0);
    wall.light[i] = Rgb(1e6f);
  }
  wall.filter();
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (i % 5 == 0) continue;
    ASSERT_NEAR(wall.at(1, i % kWidth, i / kWidth), 2.0f, 1e-3f) << i;
  }
}

}  // namespace
}  // namespace relume
