// Tests the choice of lights: probabilities sum to one, and samples follow them, for random lists and proxies.
#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

constexpr uint32_t kLights = 40;
constexpr uint32_t kWidth = 32;
constexpr uint32_t kHeight = 20;

CameraView camera_of(Projection projection) {
  CameraView camera;
  camera.projection = projection;
  camera.position = {0, 0, 5};
  camera.axes = make_frame(Vec3(0, 0, 1));
  camera.half_extent = projection == Projection::orthographic ? Vec2(3.2f, 2) : Vec2(0.8f, 0.5f);
  camera.resolution = {kWidth, kHeight};
  return camera;
}

/// Random lists for tiles of 8 pixels, at distances of 2 to 8 metres, and random proxies.
struct RandomTiles {
  RandomTiles(uint32_t seed, uint32_t listed, Projection projection = Projection::perspective) {
    testing::Random random(seed);
    const auto below = [&](uint32_t count) { return static_cast<uint32_t>(random.next() * static_cast<float>(count)); };
    TileGrid& grid = selector.tiles.grid;
    grid.camera = camera_of(projection);
    grid.tile_size = 8;
    grid.list_size = 24;
    grid.offset = {below(8), below(8)};
    grid.columns = (kWidth + 7) / 8 + 1;
    grid.rows = (kHeight + 7) / 8 + 1;
    for (uint32_t tile = 0; tile < grid.count(); ++tile) {
      for (uint32_t i = 0; i < grid.list_size; ++i) lights.push_back(below(listed));
      std::sort(lights.end() - grid.list_size, lights.end());
    }
    depths.assign(grid.count(), {2, 8});
    first.push_back(0);
    for (uint32_t i = 0; i < kLights; ++i) first.push_back(first.back() + (i % 5 == 3 ? 0 : 1 + below(1000)));
    selector.tiles.lights = view_of(lights);
    selector.tiles.depths = view_of(depths);
    selector.tiles.depth_tolerance = 1.5f;
    selector.all = {view_of(first)};
  }

  double sum(const SurfacePoint& sp) const {
    double total = 0;
    for (LightId id = 0; id < kLights; ++id) total += double{selector.pmf(sp, id)};
    return total;
  }

  AdaptiveTiles selector;
  std::vector<LightId> lights;
  std::vector<TileDepths> depths;
  std::vector<uint32_t> first;
};

SurfacePoint point_at(const Vec3& p) {
  SurfacePoint sp{};
  sp.position = Vec3(1e6f);  // only the place in the frame before counts
  sp.previous_position = p;
  return sp;
}

TEST(AdaptiveTiles, ProbabilitiesSumToOne) {
  testing::Random random(3);
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::panoramic}) {
    const RandomTiles tiles(1, kLights, projection);
    int listed = 0;
    for (int i = 0; i < 500; ++i) {
      const SurfacePoint sp = point_at(random.point(9));
      listed += tiles.selector.tiles.find(sp.previous_position) != kNoTile ? 1 : 0;
      EXPECT_NEAR(tiles.sum(sp), 1, 1e-6);
    }
    EXPECT_GT(listed, 10);  // of points inside the image
    EXPECT_LT(listed, 480);
  }
}

TEST(AdaptiveTiles, SamplesFollowTheirProbabilities) {
  constexpr int kSamples = 40000;
  testing::Random random(4);
  for (const Vec3& p : {Vec3(0), Vec3(-2.5f, 1.2f, 0), Vec3(1.1f, -0.4f, 1), Vec3(40, 0, 0)}) {
    const RandomTiles tiles(7, kLights);
    const SurfacePoint sp = point_at(p);
    std::vector<uint64_t> counts(kLights, 0);
    std::vector<uint64_t> rest(32, 0);
    for (int i = 0; i < kSamples; ++i) {
      const ReusableNumber n{random.next(), random.next_bits()};
      const LightSelection s = tiles.selector.sample(sp, n.u, n.bits);
      ASSERT_LT(s.light, kLights);
      ASSERT_FLOAT_EQ(s.pmf, tiles.selector.pmf(sp, s.light));
      ASSERT_TRUE(s.u >= 0.0f && s.u < 1.0f);
      ++counts[s.light];
      ++rest[static_cast<size_t>(s.u * 32)];
    }
    std::vector<double> expected;
    for (LightId id = 0; id < kLights; ++id) expected.push_back(double{tiles.selector.pmf(sp, id)} * kSamples);
    EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
    EXPECT_GT(testing::chi2_test(rest, std::vector<double>(32, kSamples / 32.0)).p_value, testing::significance());
  }
}

/// The mixture by its definition: entries counted one by one.
TEST(AdaptiveTiles, MixesTheListAndAllLights) {
  const RandomTiles tiles(9, kLights);
  const AdaptiveTiles& selector = tiles.selector;
  const SurfacePoint sp = point_at(Vec3(0.3f, 0.2f, 0));
  const uint32_t tile = selector.tiles.find(sp.previous_position);
  ASSERT_NE(tile, kNoTile);
  for (LightId id = 0; id < kLights; ++id) {
    const auto list = tiles.lights.begin() + tile * 24;
    const double local = static_cast<double>(std::count(list, list + 24, id)) / 24;
    const double all = static_cast<double>(tiles.first[id + 1] - tiles.first[id]) / tiles.first.back();
    EXPECT_NEAR(double{selector.pmf(sp, id)}, 0.65 * local + 0.35 * all, 1e-6) << id;
  }
}

/// Samples of lights that no longer exist are lost, and the others keep their probabilities.
TEST(AdaptiveTiles, VanishedLightsAreNotChosen) {
  const RandomTiles tiles(11, 2 * kLights);
  const SurfacePoint sp = point_at(Vec3(0));
  const uint32_t tile = tiles.selector.tiles.find(sp.previous_position);
  const auto list = tiles.lights.begin() + tile * 24;
  const auto vanished = std::count_if(list, list + 24, [](LightId id) { return id >= kLights; });
  ASSERT_GT(vanished, 2);
  EXPECT_NEAR(tiles.sum(sp), 1 - 0.65 * static_cast<double>(vanished) / 24, 1e-6);
  EXPECT_EQ(tiles.selector.pmf(sp, kLights), 0.0f);
  testing::Random random(5);
  int lost = 0;
  for (int i = 0; i < 1000; ++i) {
    const ReusableNumber n{random.next(), random.next_bits()};
    const LightSelection s = tiles.selector.sample(sp, n.u, n.bits);
    if (s.pmf > 0.0f) {
      EXPECT_LT(s.light, kLights);
    } else {
      ++lost;
    }
  }
  EXPECT_NEAR(lost / 1000.0, 0.65 * static_cast<double>(vanished) / 24, 0.08);
}

TEST(AdaptiveTiles, FindTheTileWhereTheCameraSeesAPoint) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::panoramic}) {
    const RandomTiles tiles(2, kLights, projection);
    const TileGrid& grid = tiles.selector.tiles.grid;
    testing::Random random(6);
    for (int i = 0; i < 200; ++i) {
      const auto x = static_cast<uint32_t>(random.next() * kWidth);
      const auto y = static_cast<uint32_t>(random.next() * kHeight);
      const Vec2 raster(static_cast<float>(x) + 0.1f + 0.8f * random.next(),
                        static_cast<float>(y) + 0.1f + 0.8f * random.next());
      const Ray ray = generate(grid.camera, raster, Vec2(0.5f));
      const auto at = [&](float distance) { return tiles.selector.tiles.find(ray.origin + distance * ray.direction); };
      const uint32_t tile = grid.tile_of(x, y);
      EXPECT_EQ(at(5), tile);
      EXPECT_EQ(at(1.4f), tile);  // 2 / 1.5 m is the least
      EXPECT_EQ(at(1.3f), kNoTile);
      EXPECT_EQ(at(11.9f), tile);  // 8 · 1.5 m is the most
      EXPECT_EQ(at(12.1f), kNoTile);
      if (projection != Projection::panoramic) {
        EXPECT_EQ(at(-5), kNoTile);
      }
    }
    EXPECT_EQ(tiles.selector.tiles.find(Vec3(std::numeric_limits<float>::quiet_NaN())), kNoTile);
    EXPECT_EQ(tiles.selector.tiles.find(grid.camera.position), kNoTile);
  }
}

TEST(AdaptiveTiles, ProxiesBelongToTheirLight) {
  const std::vector<uint32_t> first{0, 0, 3, 3, 3, 4, 9, 9};
  const LightProxies proxies{view_of(first)};
  const LightId owners[] = {1, 1, 1, 4, 5, 5, 5, 5, 5};
  for (uint32_t proxy = 0; proxy < 9; ++proxy) EXPECT_EQ(proxies.owner(proxy), owners[proxy]);
}

TEST(AdaptiveTiles, SelectNothingWithoutProxies) {
  AdaptiveTiles none;
  const SurfacePoint sp = point_at(Vec3(0));
  EXPECT_EQ(none.sample(sp, 0.5f, 1).pmf, 0.0f);
  EXPECT_EQ(none.pmf(sp, 0), 0.0f);
  const std::vector<uint32_t> dark{0, 0, 0};
  none.all = {view_of(dark)};
  EXPECT_EQ(none.sample(sp, 0.5f, 1).pmf, 0.0f);
  EXPECT_EQ(none.pmf(sp, 1), 0.0f);
}

}  // namespace
}  // namespace relume
