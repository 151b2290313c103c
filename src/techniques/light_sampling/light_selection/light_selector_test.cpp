// Tests the contract of every light selector: probabilities sum to one, samples follow them, and the rest of the random
// number is uniform.
#include "techniques/light_sampling/light_selection/light_selector.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

void check_light_selector(const LightSelector& selector, const SurfacePoint& sp, uint32_t light_count,
                          const std::string& name) {
  double sum = 0;
  for (LightId i = 0; i < light_count; ++i) {
    ASSERT_GE(selector.pmf(sp, i), 0.0f) << name;
    sum += selector.pmf(sp, i);
  }
  ASSERT_NEAR(sum, 1.0, 1e-5) << name;  // one rounding error per light

  constexpr int kSamples = 50000;
  std::vector<uint64_t> counts(light_count, 0);
  std::vector<uint64_t> rest(32, 0);
  testing::Random random(71);
  for (int i = 0; i < kSamples; ++i) {
    const LightSelection s = selector.sample(sp, {random.next(), random.next_bits()});
    ASSERT_LT(s.light, light_count) << name;
    ASSERT_GT(s.pmf, 0.0f) << name;
    ASSERT_FLOAT_EQ(s.pmf, selector.pmf(sp, s.light)) << name;
    ASSERT_TRUE(s.u >= 0.0f && s.u < 1.0f) << name;
    ++counts[s.light];
    ++rest[static_cast<size_t>(s.u * 32)];
  }
  std::vector<double> expected;
  for (LightId i = 0; i < light_count; ++i) expected.push_back(double{selector.pmf(sp, i)} * kSamples);
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance()) << name;
  EXPECT_GT(testing::chi2_test(rest, std::vector<double>(32, kSamples / 32.0)).p_value, testing::significance())
      << name;
  for (const float u : {0.0f, kOneMinusEpsilon}) EXPECT_GT(selector.sample(sp, {u, 1}).pmf, 0.0f) << name;
}

/// Selectors of every kind for one scene, with their data.
struct Selectors {
  explicit Selectors(const LightsView& lights, LightsAtInfinity infinity = LightsAtInfinity::worth_sampling)
      : power(build_power_lights(lights, infinity)),
        infinite(build_infinite_lights(lights, infinity)),
        tree(build_light_tree(lights, infinity)),
        all(build_exploration(lights, Vec3(0), {})),
        compact(compact_lights(lights)) {
    selector.uniform = make_uniform_lights(lights, infinity);
    selector.power = {{view_of(power)}};
    selector.tree = tree.view(lights);
    view_lists(lights);
    view_cache(lights);
    view_tiles(lights);
  }

  /// One cell that lists every second light and weighs two per sample.
  void view_lists(const LightsView& lights) {
    for (LightId i = 0; i < lights.first_infinite; i += 2) ids.push_back(i);
    first = {0, static_cast<uint32_t>(ids.size())};
    StaticLightLists& s = selector.lists;
    s.grid = {Vec3(-5), 10, UVec3(1)};
    s.first = view_of(first);
    s.ids = view_of(ids);
    s.max_lights = 2;
    s.all = {view_of(all)};
    s.infinite = make_infinite_lights(lights, view_of(infinite), true);
    s.ltc = ltc_table();
    s.compact = view_of(compact);
    s.lights = lights;
  }

  /// Region 0: four buckets, the second and the last empty. Region 1: no buckets.
  void view_cache(const LightsView& lights) {
    buckets = {{0, 4}, {0, 0}};
    entries.assign(4 * 8, CachedLight::kNone);
    entries[0] = CachedLight::pack(0, 0);
    entries[1] = CachedLight::pack(4, 3);
    entries[16] = CachedLight::pack(2, 0);
    VisibilityLightCache& c = selector.cache;
    c.regions = view_of(buckets);
    c.entries = view_of(entries);
    c.bucket_weights = view_of(bucket_weights);
    c.bucket_size = 8;
    const std::vector<LightSummary> summaries = light_summaries(lights);
    Backend backend(1);
    explored.update_digest(backend, view_of(summaries));
    explored.build(backend, view_of(summaries), lights.bounds.radius, Vec3(0), {}, 3);
    c.all = explored.grid();
    c.infinite = make_infinite_lights(lights, view_of(infinite), true);
    c.ltc = ltc_table();
    c.compact = view_of(compact);
    c.lights = lights;
  }

  /// One tile that every receiver takes lights from, with two lights.
  void view_tiles(const LightsView& lights) {
    proxies.push_back(0);
    for (const AliasEntry& entry : power)
      proxies.push_back(proxies.back() + (entry.pmf > 0 ? 1 + static_cast<uint32_t>(1e6f * entry.pmf) : 0));
    const auto last = static_cast<LightId>(lights.first_infinite) - 1;
    tile_lights = {0, 0, 0, 0, 0, last, last, last};
    AdaptiveTiles& t = selector.tiles;
    t.all = {view_of(proxies)};
    t.tiles.grid.camera.position = Vec3(0, 0, 3);
    t.tiles.grid.camera.axes = make_frame(Vec3(0, 0, 1));
    t.tiles.grid.camera.resolution = Vec2(4);
    t.tiles.grid.tile_size = 4;
    t.tiles.grid.list_size = 8;
    t.tiles.grid.columns = t.tiles.grid.rows = 1;
    t.tiles.lights = view_of(tile_lights);
    t.tiles.depths = view_of(tile_depths);
  }

  /// Adds the lights at infinity to the lists of region 0, where they are rarely visible.
  void list_infinite(const LightsView& lights) {
    for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
      uint32_t slot = id % 4 * 8;
      while (entries[slot] != CachedLight::kNone) ++slot;
      entries[slot] = CachedLight::pack(id, 0);
      compact.push_back(compact_form(lights, lights.lights[id]));
    }
    float filled = 0;
    for (uint32_t b = 0; b < 4; ++b) filled += entries[8 * b] != CachedLight::kNone ? 1.0f : 0.0f;
    for (uint32_t b = 0; b < 4; ++b) bucket_weights[b] = entries[8 * b] != CachedLight::kNone ? 1 / filled : 0.0f;
    shares.resize(1);
    shares[0].visibility = {{0.3f, 0.01f, 0.1f, 1.0f}};
    shares[0].exploration = 0.25f;
    VisibilityLightCache& c = selector.cache;
    c.compact = view_of(compact);
    c.shares = view_of(shares);
    c.lists_infinite = true;
    c.learns_exploration = true;
  }

  LightSelector selector;
  std::vector<AliasEntry> power;
  std::vector<AliasEntry> infinite;
  LightTreeData tree;
  std::vector<AliasEntry> all;
  ExplorationTables explored{host_memory()};
  std::vector<CompactLight> compact;
  std::vector<uint32_t> first;
  std::vector<LightId> ids;
  std::vector<LightBuckets> buckets;
  std::vector<uint32_t> entries;
  std::vector<float> bucket_weights{0.7f, 0, 0.3f, 0};
  std::vector<uint32_t> proxies;
  std::vector<LightId> tile_lights;
  std::vector<TileDepths> tile_depths{{2, 4}};
  std::vector<LightShares> shares;
};

/// A default SurfacePoint, and points that see the lamps well, at a grazing angle, from behind and through glass.
std::vector<SurfacePoint> receivers() {
  std::vector<SurfacePoint> points{SurfacePoint{}};
  const auto add = [&](const Vec3& p, const Vec3& n, float transmission, float roughness, uint32_t region) {
    SurfacePoint sp{};
    sp.position = p;
    sp.frame = make_frame(glm::normalize(n));
    sp.ng = sp.frame.n;
    sp.wo_local = glm::normalize(Vec3(0.3f, -0.2f, 0.8f));
    MaterialSample m;
    m.base_color = Rgb(0.7f);
    m.roughness = roughness;
    m.transmission = transmission;
    make_bsdf(sp.bsdf, m, MaterialData{}, energy_tables(), sp.wo_local.z, true);
    sp.region = region;
    points.push_back(sp);
  };
  add(Vec3(0, 0, 0), Vec3(0, 1, 0), 0, 0.5f, 0);
  add(Vec3(-1, 1.2f, 0.2f), Vec3(1, 0.2f, 0.3f), 0, 1, 0);
  add(Vec3(0, 3, 0), Vec3(0, 1, 0), 0, 0.7f, 0);
  add(Vec3(0.5f, 0.3f, 0), Vec3(0, -1, 0), 1, 0.5f, 1);
  return points;
}

TEST(LightSelector, EveryKindKeepsTheContract) {
  Environment sky;
  sky.kind = EnvironmentKind::sun_sky;
  for (const Environment& environment :
       {Environment{}, testing::constant_environment(), testing::noise_environment(24, 12), sky}) {
    const testing::LightScene scene = testing::make_light_scene(environment);
    const LightsView& lights = scene.lights();
    Selectors selectors(lights);
    for (int k = 0; k < kLightSelectorKindCount; ++k) {
      selectors.selector.kind = static_cast<LightSelectorKind>(k);
      for (const SurfacePoint& sp : receivers()) {
        check_light_selector(selectors.selector, sp, lights.lights.size, "selector " + std::to_string(k));
      }
    }
  }
}

TEST(LightSelector, LightCachesCanListLightsAtInfinity) {
  Environment sky;
  sky.kind = EnvironmentKind::sun_sky;
  for (const Environment& environment :
       {Environment{}, testing::constant_environment(), testing::noise_environment(24, 12), sky}) {
    const testing::LightScene scene = testing::make_light_scene(environment);
    const LightsView& lights = scene.lights();
    Selectors selectors(lights);
    selectors.list_infinite(lights);
    selectors.selector.kind = LightSelectorKind::cache;
    for (const SurfacePoint& sp : receivers())
      check_light_selector(selectors.selector, sp, lights.lights.size, "lights at infinity");
    // Half of the exploration, without a list.
    float infinite = 0;
    for (LightId id = lights.first_infinite; id < lights.lights.size; ++id)
      infinite += selectors.selector.pmf(receivers()[4], id);
    EXPECT_NEAR(infinite, 0.5f, 1e-5f);
  }
}

TEST(LightSelector, EveryKindButUniformCanExcludeTheEnvironment) {
  Environment sky;
  sky.kind = EnvironmentKind::sun_sky;
  const testing::LightScene scene = testing::make_light_scene(sky);
  const LightsView& lights = scene.lights();
  Selectors selectors(lights, LightsAtInfinity::unreachable);
  for (int k = 0; k < kLightSelectorKindCount; ++k) {
    selectors.selector.kind = static_cast<LightSelectorKind>(k);
    for (LightId i = lights.first_infinite; i < lights.lights.size; ++i) {
      const bool delta = lights.lights[i].kind == LightKind::directional && lights.lights[i].directional.delta();
      const bool chosen = selectors.selector.pmf(receivers()[1], i) > 0;
      if (delta) {
        EXPECT_TRUE(chosen) << k;  // no other technique samples it
      } else if (k != static_cast<int>(LightSelectorKind::uniform)) {
        EXPECT_FALSE(chosen) << k << " " << i;
      }
    }
  }
}

TEST(LightSelector, OtherLightsRemainIfPowersOverflow) {
  const CompiledScene scene(testing::make_overpowered_scene(), {.camera = {}, .width = 16, .height = 16});
  const LightsView& lights = scene.view().lights;
  ASSERT_EQ(lights.lights.size, 3u);
  ASSERT_FALSE(is_finite(luminance(power(lights, 0))));
  Selectors selectors(lights);
  const SurfacePoint sp = receivers()[1];
  for (const LightSelectorKind kind :
       {LightSelectorKind::power, LightSelectorKind::light_tree, LightSelectorKind::static_lists}) {
    selectors.selector.kind = kind;
    float sum = 0;
    for (LightId i = 0; i < lights.lights.size; ++i) sum += selectors.selector.pmf(sp, i);
    EXPECT_NEAR(sum, 1.0f, 1e-5f) << static_cast<int>(kind);
    // By power alone, the point light is almost never chosen.
    EXPECT_GT(selectors.selector.pmf(sp, 2), kind == LightSelectorKind::power ? 0.0f : 0.1f) << static_cast<int>(kind);
  }
  const AliasTable explored = selectors.explored.grid().at(sp.position);
  EXPECT_NEAR(explored.pmf(0) + explored.pmf(1) + explored.pmf(2), 1.0f, 1e-5f);
  EXPECT_GT(explored.pmf(2), 0.0f);
}

TEST(LightSelector, OverflowingPowersKeepOtherInfiniteLights) {
  std::vector<Light> directions(2);
  for (Light& light : directions) {
    light.kind = LightKind::directional;
    light.directional = {Vec3(0, 1, 0), Rgb(3e38f), 0};
  }
  LightsView lights;
  lights.lights = view_of(directions);
  lights.bounds.radius = 10;
  const auto entries = build_infinite_lights(lights);
  ASSERT_EQ(entries.size(), 2u);
  for (const AliasEntry& entry : entries) EXPECT_FLOAT_EQ(entry.pmf, 0.5f);
}

TEST(LightSelector, SelectsNothingWithoutLights) {
  for (int k = 0; k < kLightSelectorKindCount; ++k) {
    LightSelector selector;
    selector.kind = static_cast<LightSelectorKind>(k);
    EXPECT_EQ(selector.sample(SurfacePoint{}, {0.5f, 1}).pmf, 0.0f);
    EXPECT_EQ(selector.pmf(SurfacePoint{}, 0), 0.0f);
  }
}

}  // namespace
}  // namespace relume
