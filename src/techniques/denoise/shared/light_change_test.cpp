#include "techniques/denoise/shared/light_change.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "testing/random.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 128;
constexpr uint32_t kPixels = kSize * kSize;
constexpr uint32_t kAge = 8;
constexpr uint32_t kColumns = change_blocks(kSize);

/// A white wall at rest, on which one sample in eight finds light.
struct Wall {
  explicit Wall(uint32_t seed) {
    testing::Random random(seed);
    for (uint32_t i = 0; i < kPixels; ++i) {
      float sum = 0;
      for (uint32_t k = 0; k < kAge; ++k) sum += sample(random);
      light_before[i] = Rgb(sum / kAge);
      scattered[i] = Rgb(sample(random));
    }
  }
  static float sample(testing::Random& random) { return random.next() < 0.125f ? 8.0f : 0.0f; }

  std::vector<float> departures() const {
    LightHistory history{
        .reprojection = {view_of(motion), view_of(position), view_of(normal), view_of(depth), view_of(surface),
                         view_of(position), view_of(normal), view_of(surface), kSize, kSize},
        .samples = {view_of(scattered), view_of(scattered), {}, view_of(albedo), {}},
        .light_before = view_of(light_before),
        .count_before = view_of(count),
        .light = {},
        .count = {},
        .max_samples = kAge,
        .discounts = {}};
    std::vector<float> result(kColumns * kColumns);
    const CompareBlocksKernel compare{history, mutable_view_of(result), kSize, kSize};
    for (uint32_t i = 0; i < result.size(); ++i) compare(i % kColumns, i / kColumns);
    return result;
  }

  std::vector<float> discounts() const {
    const std::vector<float> of_blocks = departures();
    std::vector<float> result(of_blocks.size());
    const DiscountBlocksKernel discount{view_of(of_blocks), mutable_view_of(result), kColumns, kColumns};
    for (uint32_t i = 0; i < result.size(); ++i) discount(i % kColumns, i / kColumns);
    return result;
  }

  std::vector<Vec2> motion = std::vector<Vec2>(kPixels, Vec2(0));
  std::vector<Vec3> position = std::vector<Vec3>(kPixels, Vec3(0));
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<float> depth = std::vector<float>(kPixels, 1.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels, 1);
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, kAge);
  std::vector<Rgb> light_before = std::vector<Rgb>(kPixels);
  std::vector<Rgb> scattered = std::vector<Rgb>(kPixels);
};

TEST(LightChange, NoiseIsRarelyTakenForAChange) {
  size_t blocks = 0;
  size_t discounted = 0;
  for (uint32_t seed = 1; seed <= 16; ++seed) {
    const std::vector<float> discounts = Wall(seed).discounts();
    blocks += discounts.size();
    discounted += static_cast<size_t>(std::count_if(discounts.begin(), discounts.end(), [](float d) { return d > 0; }));
  }
  EXPECT_LT(discounted * 10, blocks);
}

TEST(LightChange, SharedNoiseIsNotTakenForAChange) {
  // Half a pixel of motion: four pixels fetch each pixel of a history of one sample.
  double sum = 0;
  size_t blocks = 0;
  for (uint32_t seed = 1; seed <= 64; ++seed) {
    Wall wall(seed);
    testing::Random random(seed + 1000);
    for (Rgb& light : wall.light_before) light = Rgb(Wall::sample(random));
    std::fill(wall.motion.begin(), wall.motion.end(), Vec2(0.5f));
    std::fill(wall.count.begin(), wall.count.end(), 1u);
    for (const float d : wall.departures()) {
      if (d < 0) continue;
      sum += static_cast<double>(d);
      ++blocks;
    }
  }
  EXPECT_NEAR(sum / static_cast<double>(blocks), 1.0, 0.1);  // 1.6 without the correction
}

TEST(LightChange, LampsThatGoOutDiscountTheirHistory) {
  Wall wall(1);
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (i % kSize < kSize / 2) wall.scattered[i] = Rgb(0);
  }
  const std::vector<float> discounts = wall.discounts();
  for (uint32_t i = 0; i < discounts.size(); ++i) {
    if (i % kColumns < kColumns / 2 - 1) {
      EXPECT_GT(discounts[i], 1.0f) << i;  // the history counts for less than one sample
    }
  }
}

TEST(LightChange, LargerChangesDiscountHistoryMore) {
  double before = 0;
  for (const float factor : {1.5f, 2.0f, 4.0f}) {
    Wall wall(2);
    for (Rgb& light : wall.scattered) light *= factor;
    double sum = 0;
    for (const float d : wall.discounts()) sum += static_cast<double>(d);
    EXPECT_GT(sum, before) << factor;
    before = sum;
  }
}

TEST(LightChange, IsDetectedBesideTexelsWithoutHistory) {
  // Every other column is black. After motion by half a pixel, each pixel has a black tap.
  Wall wall(1);
  std::fill(wall.motion.begin(), wall.motion.end(), Vec2(0.5f, 0));
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (i % 2 == 0) continue;
    wall.albedo[i] = Rgb(0);
    wall.count[i] = 0;
  }
  for (Rgb& light : wall.scattered) light = Rgb(0);
  for (const float d : wall.discounts()) EXPECT_GT(d, 1.0f);
}

TEST(LightChange, DiscountsAreZeroWithoutHistory) {
  Wall wall(3);
  std::fill(wall.count.begin(), wall.count.end(), 0u);
  for (const float d : wall.discounts()) EXPECT_EQ(d, 0.0f);
}

TEST(LightChange, DiscountsAreInterpolatedBetweenBlocks) {
  LightHistory history{};
  history.reprojection.width = history.reprojection.height = 2 * kChangeBlock;
  history.max_samples = kAge;
  const std::vector<float> discounts{0.5f, 1.5f, 0.5f, 1.5f};
  EXPECT_EQ(history.limit_at(8, 8), kAge);
  history.discounts = view_of(discounts);
  EXPECT_FLOAT_EQ(history.discount_at(0, 0), 0.5f);
  EXPECT_FLOAT_EQ(history.discount_at(15, 3), 1.5f);
  EXPECT_NEAR(history.discount_at(7, 8) + history.discount_at(8, 8), 2.0f, 1e-6f);
  EXPECT_EQ(history.limit_at(0, 0), 2u);
  EXPECT_EQ(history.limit_at(15, 0), 0u);
}

}  // namespace
}  // namespace relume
