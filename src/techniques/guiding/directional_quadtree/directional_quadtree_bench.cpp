#include <benchmark/benchmark.h>

#include <vector>

#include "core/hash.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"

namespace relume {
namespace {

/// A tree adapted to a small bright spot, and the samples of its last frame.
struct Adapted {
  DirectionalQuadtree tree;
  std::vector<DirectionSample> samples;
};

Adapted adapted_tree(uint32_t bit_count) {
  Adapted a{uniform_quadtree(bit_count), {}};
  const Vec3 sun = glm::normalize(Vec3(0.4f, 0.8f, 0.3f));
  for (uint32_t frame = 0; frame < 40; ++frame) {
    a.samples.clear();
    for (uint32_t i = 0; i < 2048; ++i) {
      const Vec3 w = a.tree.sample({to_unit_float(hash(i, frame, 0u)), to_unit_float(hash(i, frame, 1u))});
      const float radiance = glm::dot(w, sun) > 0.995f ? 1000.0f : 0.1f;
      a.samples.push_back({pack_square(square_from_direction(w)), radiance / a.tree.pdf(w)});
    }
    QuadtreeWeights w{};
    adapt(a.tree, w, [&](uint32_t i) { return a.samples[i]; }, 2048, {});
  }
  return a;
}

void bm_quadtree_sample(benchmark::State& state) {
  const DirectionalQuadtree tree = adapted_tree(static_cast<uint32_t>(state.range(0))).tree;
  const bool stratified = state.range(1) != 0;
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    const Vec2 u(to_unit_float(i), to_unit_float(hash(i)));
    benchmark::DoNotOptimize(stratified ? tree.sample_stratified(u) : tree.sample(u));
  }
}
BENCHMARK(bm_quadtree_sample)->ArgNames({"bits", "stratified"})->ArgsProduct({{32, 128}, {0, 1}});

void bm_quadtree_pdf(benchmark::State& state) {
  const DirectionalQuadtree tree = adapted_tree(static_cast<uint32_t>(state.range(0))).tree;
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    benchmark::DoNotOptimize(tree.pdf(direction_from_square({to_unit_float(i), to_unit_float(hash(i))})));
  }
}
BENCHMARK(bm_quadtree_pdf)->ArgName("bits")->Arg(32)->Arg(128);

/// Adapts as in the paper, or with memory and spread.
void bm_quadtree_adapt(benchmark::State& state) {
  Adapted a = adapted_tree(128);
  const bool lasting = state.range(1) != 0;
  const QuadtreeAdaption options{.migrations = static_cast<uint32_t>(state.range(0)),
                                 .kept = lasting ? 8.0f / 9 : 0.0f,
                                 .spread = lasting ? 1.0f : 0.0f};
  for (auto _ : state) {
    DirectionalQuadtree tree = a.tree;
    QuadtreeWeights w{};
    adapt(
        tree, w, [&](uint32_t i) { return a.samples[i]; }, 2048, options);
    benchmark::DoNotOptimize(tree);
  }
  state.SetItemsProcessed(state.iterations() * 2048);
}
BENCHMARK(bm_quadtree_adapt)->ArgNames({"migrations", "lasting"})->ArgsProduct({{1, 4}, {0, 1}});

}  // namespace
}  // namespace relume
