// Tests how lists and proxies follow from the feedback of a frame.
#include "techniques/light_sampling/adaptive_tiles/fill_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/stream_io.h"
#include "techniques/light_sampling/adaptive_tiles/learned_tiles.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 40;
constexpr uint32_t kHeight = 24;
constexpr uint32_t kLights = 50;
constexpr float kDistance = 5;

/// Feedback of a frame whose camera looks at a plane, one light per pixel.
class FilledTiles : public ::testing::Test {
 protected:
  FilledTiles() : power_(kLights, AliasEntry{1, 0, 1.0f / kLights}), feedback_(kWidth * kHeight) {
    camera_.axes = make_frame(Vec3(0, 0, 1));
    camera_.half_extent = {1, 0.6f};
    camera_.resolution = {kWidth, kHeight};
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x) meet(x, y, place(x, y), place(x, y));
  }

  Vec3 place(uint32_t x, uint32_t y) const {
    const Ray ray = generate(camera_, {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f}, Vec2(0.5f));
    return ray.origin + ray.direction * (kDistance / -ray.direction.z);
  }
  LightFeedback& at(uint32_t x, uint32_t y) { return feedback_[y * kWidth + x]; }
  void meet(uint32_t x, uint32_t y, const Vec3& now, const Vec3& before) {
    at(x, y).position = now;
    at(x, y).previous_position = before;
  }

  FrameFeedback frame() const { return {view_of(feedback_), kWidth, kHeight, camera_}; }
  void build_proxies(LearnedTiles& tiles) {
    tiles.build_proxies({backend_, "test", scratch_}, view_of(power_), {}, 0, 0.75f);
  }
  LearnedTiles filled(const TileOptions& options, uint32_t seed = 1) { return filled(options, seed, none_); }
  LearnedTiles filled(const TileOptions& options, uint32_t seed, const LearnedTiles& before) {
    LearnedTiles tiles(host_memory());
    build_proxies(tiles);
    tiles.fill(backend_, frame(), before, options, seed);
    return tiles;
  }
  static std::map<LightId, int> counts_of(const LearnedTiles& tiles, uint32_t tile) {
    std::map<LightId, int> counts;
    for (uint32_t i = 0; i < tiles.grid().list_size; ++i) ++counts[tiles.lists(1).light(tile, i)];
    return counts;
  }

  Backend backend_{1};
  PrimitiveScratch scratch_;
  CameraView camera_;
  std::vector<AliasEntry> power_;
  std::vector<LightFeedback> feedback_;
  LearnedTiles none_{host_memory()};
};

TEST_F(FilledTiles, HoldEachPixelsLightAndTheRestFromAround) {
  testing::Random random(1);
  for (LightFeedback& f : feedback_) f.offer(static_cast<LightId>(random.next() * kLights), false, 1, 0);
  for (const bool jitter : {false, true}) {
    const LearnedTiles tiles = filled({.jitter = jitter});
    const TileGrid& grid = tiles.grid();
    std::vector<std::map<LightId, int>> own(grid.count());
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x) ++own[grid.tile_of(x, y)][at(x, y).id()];
    for (uint32_t tile = 0; tile < grid.count(); ++tile) {
      const std::map<LightId, int> counts = counts_of(tiles, tile);
      for (const auto& [light, count] : own[tile]) EXPECT_GE(counts.count(light) ? counts.at(light) : 0, count);
      const View<const LightId> all = tiles.lists(1).lights;
      const LightId* const list = all.data + size_t{tile} * grid.list_size;
      EXPECT_TRUE(std::is_sorted(list, list + grid.list_size));
    }
  }
}

TEST_F(FilledTiles, TakeLightsAroundByTheirContribution) {
  // In each block of 2 × 2 pixels, light 7 contributes nine times as much as the others together.
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) {
      const bool bright = x % 2 == 0 && y % 2 == 0;
      at(x, y).offer(bright ? 7 : 3, false, bright ? 27.0f : 1.0f, 0);
    }
  const LearnedTiles tiles = filled({.jitter = false, .depth_tolerance = 2});
  double bright = 0;
  for (uint32_t tile = 0; tile < tiles.grid().count(); ++tile) bright += counts_of(tiles, tile)[7];
  const double lists = tiles.grid().count();
  // A quarter of the 64 pixels, and nine tenths of the 64 blocks around, which may be shifted by a pixel.
  EXPECT_NEAR(bright / lists, 16 + 0.9 * 64, 3);
}

TEST_F(FilledTiles, LaterVerticesOnlyCountForAllLights) {
  for (LightFeedback& f : feedback_) f.offer(4, true, 1, 0);
  at(0, 0) = {};
  std::vector<uint32_t> counts(kLights, 0);
  launch(backend_, "test", CountUsedLightsKernel{view_of(feedback_), view_of(power_), kWidth, mutable_view_of(counts)},
         kWidth, kHeight);
  EXPECT_EQ(counts[4], kWidth * kHeight - 1);
  const LearnedTiles tiles = filled({});
  int fours = 0;
  for (uint32_t tile = 0; tile < tiles.grid().count(); ++tile) fours += counts_of(tiles, tile)[4];
  // Entries are lights by power, of which light 4 is one in fifty.
  EXPECT_LT(fours, 0.06 * tiles.grid().count() * 128);
}

/// Pixels without a light take those of the list that their surface had before.
TEST_F(FilledTiles, KeepsLightsOfSurfacesThatMove) {
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) at(x, y).offer(x / 8, false, 1, 0);
  const LearnedTiles before = filled({.list_size = 64, .jitter = false});
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      at(x, y) = {};
      if (x < kWidth - 8) meet(x, y, place(x, y), place(x + 8, y));
    }
  }
  const LearnedTiles tiles = filled({.list_size = 64, .jitter = false}, 2, before);
  for (uint32_t column = 0; column < 4; ++column)
    EXPECT_EQ(counts_of(tiles, column), (std::map<LightId, int>{{column + 1, 64}})) << column;
  // Pixels without a surface keep the list of their place.
  EXPECT_EQ(counts_of(tiles, 4), (std::map<LightId, int>{{4, 64}}));
}

TEST_F(FilledTiles, ReplacesUnknownLights) {
  for (LightFeedback& f : feedback_) f.offer(kLights + 5, false, 1, 0);
  power_[9].pmf = 0;
  at(3, 3) = {};
  at(3, 3).offer(9, false, 1, 0);
  const LearnedTiles tiles = filled({});
  for (const LightId light : tiles.read_lights()) {
    EXPECT_LT(light, kLights);
    EXPECT_NE(light, 9u);
  }
}

TEST_F(FilledTiles, StoreTheDistancesOfTheirSurfaces) {
  const LearnedTiles before = filled({.jitter = false});
  const auto depths = [](const LearnedTiles& tiles, uint32_t tile) { return tiles.lists(1).depths[tile]; };
  TileDepths expected;
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 8; ++x) expected.add(glm::length(place(x, y)));
  EXPECT_FLOAT_EQ(depths(before, 0).nearest, expected.nearest);
  EXPECT_FLOAT_EQ(depths(before, 0).farthest, expected.farthest);
  for (LightFeedback& f : feedback_) f = {};
  EXPECT_TRUE(depths(filled({.jitter = false}), 0).empty());
  EXPECT_FLOAT_EQ(depths(filled({.jitter = false}, 3, before), 0).nearest, expected.nearest);
}

TEST_F(FilledTiles, AreTheSameWithAnyNumberOfThreads) {
  testing::Random random(2);
  for (LightFeedback& f : feedback_) {
    if (random.next() < 0.7f) f.offer(static_cast<LightId>(random.next() * kLights), random.next() < 0.2f, 1, 0);
  }
  const LearnedTiles one = filled({});
  Backend three(3);
  LearnedTiles other(host_memory());
  build_proxies(other);
  other.fill(three, frame(), none_, {}, 1);
  EXPECT_TRUE(std::ranges::equal(one.read_lights(), other.read_lights()));
}

TEST_F(FilledTiles, ListsOfFewerEntriesThanPixelsTakeAPixelOfEachStratum) {
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) at(x, y).offer(y % 16, false, 1, 0);
  const LearnedTiles tiles = filled({.tile_size = 16, .list_size = 16, .jitter = false});
  for (LightId row = 0; row < 16; ++row) EXPECT_EQ(counts_of(tiles, 0)[row], 1) << row;
}

TEST_F(FilledTiles, AreConsistentUntilDamaged) {
  const LearnedTiles tiles = filled({});
  std::stringstream stream;
  tiles.save(stream);
  LearnedTiles loaded(host_memory());
  loaded.load(stream);
  ASSERT_TRUE(stream);
  EXPECT_TRUE(loaded.consistent(kWidth, kHeight, kLights));
  EXPECT_TRUE(std::ranges::equal(loaded.read_lights(), tiles.read_lights()));
  EXPECT_FALSE(loaded.consistent(kWidth + 8, kHeight, kLights));
  EXPECT_FALSE(loaded.consistent(kWidth, kHeight, kLights + 1));
  EXPECT_TRUE(LearnedTiles(host_memory()).consistent(kWidth, kHeight, kLights));
  // The first two entries of a list, in the wrong order.
  std::string bytes = stream.str();
  const LightId wrong[] = {7, 3};
  std::memcpy(bytes.data() + sizeof(TileGrid) + sizeof(uint64_t), wrong, sizeof(wrong));
  std::stringstream damaged(bytes);
  loaded.load(damaged);
  ASSERT_TRUE(damaged);
  EXPECT_FALSE(loaded.consistent(kWidth, kHeight, kLights));
}

/// Raster positions of such cameras are NaN, which no tile has.
TEST_F(FilledTiles, AreInconsistentWithADamagedCamera) {
  EXPECT_TRUE(filled({}).consistent(kWidth, kHeight, kLights));
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), kInfinity, 3e38f, 0.0f}) {
    CameraView damaged = camera_;
    damaged.axes.t = Vec3(bad);
    std::swap(damaged, camera_);
    EXPECT_FALSE(filled({}).consistent(kWidth, kHeight, kLights)) << bad;
    std::swap(damaged, camera_);
  }
}

/// Feedback of two frames by the same camera, with the first in place of an older one.
class KeptLights : public FilledTiles {
 protected:
  KeptLights() : before_(feedback_) {}

  void keep(float decay, uint32_t seed = 1) {
    KeepLightsKernel kernel;
    kernel.feedback = mutable_view_of(feedback_);
    kernel.before = view_of(before_);
    kernel.camera = kernel.camera_before = camera_;
    kernel.power = view_of(power_);
    kernel.depth_tolerance = 1.5f;
    kernel.decay = decay;
    kernel.seed = seed;
    for (uint32_t y = 0; y < kHeight; ++y)
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
  }
  LightFeedback& old(uint32_t x, uint32_t y) { return before_[y * kWidth + x]; }

  std::vector<LightFeedback> before_;
};

TEST_F(KeptLights, CompeteByContributionsOfAllFrames) {
  for (LightFeedback& f : before_) f.offer(1, false, 3, 0);
  for (LightFeedback& f : feedback_) f.offer(2, true, 1, 0);
  keep(0.5f);
  int old = 0;
  for (const LightFeedback& f : feedback_) {
    EXPECT_EQ(f.weight, 2.5f);
    EXPECT_EQ(f.is_direct(), f.id() == 1);
    old += f.id() == 1 ? 1 : 0;
  }
  const double pixels = kWidth * kHeight;
  EXPECT_NEAR(old / pixels, 1.5 / 2.5, 5 * std::sqrt(0.24 / pixels));
}

TEST_F(KeptLights, StayWhileNoOtherIsFound) {
  for (LightFeedback& f : before_) f.offer(1, false, 3, 0);
  for (uint32_t frame = 0; frame < 1000; ++frame) {
    keep(0.8f, frame);
    before_ = feedback_;
    for (LightFeedback& f : feedback_) {
      f.light = kNoLight;
      f.weight = 0;
    }
  }
  for (const LightFeedback& f : before_) EXPECT_EQ(f.light, 1u);
  // The first light that is found replaces them.
  for (LightFeedback& f : feedback_) f.offer(2, false, 1e-6f, 0);
  keep(0.8f);
  for (const LightFeedback& f : feedback_) EXPECT_EQ(f.light, 2u);
}

TEST_F(KeptLights, FollowSurfaces) {
  for (uint32_t y = 0; y < kHeight; ++y)
    for (uint32_t x = 0; x < kWidth; ++x) old(x, y).offer(x, false, 1, 0);
  meet(3, 4, place(3, 4), place(9, 4));
  meet(5, 4, place(5, 4), camera_.position + 2.0f * (place(5, 4) - camera_.position));  // another surface
  meet(7, 4, place(7, 4), camera_.position + Vec3(0, 0, 1));                            // was outside the image
  old(8, 4).position = Vec3(kInfinity);
  keep(0.8f);
  EXPECT_EQ(at(2, 4).light, 2u);
  EXPECT_EQ(at(3, 4).light, 9u);
  for (const uint32_t x : {5u, 7u, 8u}) EXPECT_EQ(at(x, 4).light, kNoLight) << x;
}

/// Pixels without a path keep the surface that the camera still sees there.
TEST_F(KeptLights, OutlastFramesWithoutAPath) {
  for (LightFeedback& f : before_) f.offer(1, false, 1, 0);
  for (LightFeedback& f : feedback_) f = {};
  old(3, 4).position = place(4, 4);
  keep(0.8f);
  EXPECT_EQ(at(2, 4).light, 1u);
  EXPECT_EQ(at(2, 4).position, place(2, 4));
  EXPECT_EQ(at(2, 4).previous_position, place(2, 4));
  EXPECT_EQ(at(3, 4).light, kNoLight);
  EXPECT_FALSE(at(3, 4).has_surface());
}

TEST_F(KeptLights, AreOnlyThoseThatLightSelectionChooses) {
  power_[9].pmf = 0;
  for (LightFeedback& f : before_) f.offer(kLights, false, 1, 0);
  old(3, 4) = old(2, 4);
  old(3, 4).light = 9;
  keep(0.8f);
  for (const LightFeedback& f : feedback_) EXPECT_EQ(f.light, kNoLight);
}

TEST(ProxyCounts, BlendPowerAndUse) {
  const std::vector<AliasEntry> power{{1, 0, 0.5f}, {1, 1, 0}, {1, 2, 0.25f}, {1, 3, 0.25f}};
  const std::vector<uint32_t> counts{0, 8, 6, 2};
  const ProxyCounts used{view_of(power), view_of(counts), 8, 0.75f};
  const double budget = 0x1p24;
  EXPECT_NEAR(used(0) / budget, 0.25 * 0.5, 1e-6);
  EXPECT_EQ(used(1), 0u);
  EXPECT_NEAR(used(2) / budget, 0.25 * 0.25 + 0.75 * 0.75, 1e-6);
  EXPECT_NEAR(used(3) / budget, 0.25 * 0.25 + 0.75 * 0.25, 1e-6);
  EXPECT_EQ(used(4), 0u);
  const ProxyCounts unused{view_of(power), {}, 0, 0.75f};
  EXPECT_NEAR(unused(2) / budget, 0.25, 1e-6);
}

TEST(LightFeedback, KeepsALightInProportionToItsContribution) {
  constexpr int kRuns = 20000;
  const std::vector<double> contributions{1, 0, 3, 0.5, 2.5};
  testing::Random random(8);
  std::vector<uint64_t> kept(contributions.size(), 0);
  for (int run = 0; run < kRuns; ++run) {
    LightFeedback f;
    for (LightId id = 0; id < contributions.size(); ++id)
      f.offer(id, id > 2, static_cast<float>(contributions[id]), random.next());
    ASSERT_EQ(f.weight, 7.0f);
    ASSERT_EQ(f.is_direct(), f.id() <= 2);
    ++kept[f.id()];
  }
  std::vector<double> expected;
  for (const double contribution : contributions) expected.push_back(contribution / 7 * kRuns);
  EXPECT_GT(testing::chi2_test(kept, expected).p_value, testing::significance());
}

TEST(LightFeedback, IgnoresWhatIsNotFinite) {
  LightFeedback f;
  EXPECT_FALSE(f.has_surface());
  EXPECT_FALSE(f.is_direct());
  f.offer(1, false, std::numeric_limits<float>::quiet_NaN(), 0);
  f.offer(2, false, kInfinity, 0);
  f.offer(3, false, -1, 0);
  EXPECT_EQ(f.light, kNoLight);
  EXPECT_EQ(f.weight, 0.0f);
}

}  // namespace
}  // namespace relume
