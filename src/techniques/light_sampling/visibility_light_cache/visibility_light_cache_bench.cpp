#include <benchmark/benchmark.h>

#include <algorithm>
#include <vector>

#include "core/hash.h"
#include "lights/testing/lamps.h"
#include "materials/make_bsdf.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"

namespace relume {
namespace {

/// Eight regions, each with samples of all lamps.
struct World {
  explicit World(uint32_t count) : lights(testing::make_lamps(count, 30)), tree(Vec3(15), 30) {
    view.lights = view_of(lights);
    view.first_infinite = count;
    all = build_exploration(view, Vec3(0), {});
    compact = compact_lights(view);
    stream.resize(backend, 8 * 4096, 1);
    for (uint32_t i = 0; i < 8 * 4096; ++i) stream.samples()[i] = {i % 8, (hash(i) % count) | kVisibleLight, 0, 0};
    stream.group(backend, 8);
    summaries = light_summaries(view);
    caches.build(backend, tree, stream.groups(), view_of(summaries), {});
    cache.regions = caches.buckets();
    cache.entries = caches.entries();
    cache.bucket_weights = caches.bucket_weights();
    cache.all = {view_of(all)};
    cache.infinite.first = count;
    cache.ltc = ltc_table();
    cache.compact = view_of(compact);
    cache.lights = view;
  }

  std::vector<Light> lights;
  LightsView view;
  Backend backend{1};
  OctreeTree tree;
  SampleStream stream;
  std::vector<LightSummary> summaries;
  LightCaches caches;
  std::vector<AliasEntry> all;
  std::vector<CompactLight> compact;
  VisibilityLightCache cache;
};

void bm_light_cache_sample(benchmark::State& state) {
  World world(static_cast<uint32_t>(state.range(0)));
  SurfacePoint sp{};
  sp.frame = make_frame(Vec3(0, 1, 0));
  sp.wo_local = Vec3(0, 0, 1);
  make_bsdf(sp.bsdf, MaterialSample{}, MaterialData{}, energy_tables(), 1, true);
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    sp.position = {30 * to_unit_float(hash(i, 1u)), 0, 30 * to_unit_float(hash(i, 2u))};
    sp.region = world.tree.view().find(sp.position);
    benchmark::DoNotOptimize(world.cache.sample(sp, {to_unit_float(i), i}));
  }
}
BENCHMARK(bm_light_cache_sample)->ArgName("lights")->Arg(8)->Arg(32)->Arg(500);

void bm_light_cache_build(benchmark::State& state) {
  const auto count = static_cast<uint32_t>(state.range(0));
  World world(count);
  for (auto _ : state)
    world.caches.build(world.backend, world.tree, world.stream.groups(), view_of(world.summaries), {});
  state.SetItemsProcessed(state.iterations() * 8 * 4096);
}
BENCHMARK(bm_light_cache_build)->ArgName("lights")->Arg(8)->Arg(500)->Unit(benchmark::kMicrosecond);

void bm_sample_stream_group(benchmark::State& state) {
  Backend backend;
  SampleStream stream;
  const uint32_t pixels = 1 << 20;
  stream.resize(backend, pixels, 2);
  for (uint32_t i = 0; i < 2 * pixels; ++i) stream.samples()[i].region = (i / 64 * 7919u) % 4096;  // runs, as in images
  for (auto _ : state) stream.group(backend, 4096);
  state.SetItemsProcessed(state.iterations() * 2 * pixels);
}
BENCHMARK(bm_sample_stream_group)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
