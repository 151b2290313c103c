#include <benchmark/benchmark.h>

#include <vector>

#include "core/hash.h"
#include "core/octahedral.h"
#include "techniques/spatial/octree/octree_tree.h"

namespace relume {
namespace {

Vec3 point_on_sphere(uint32_t i) {
  return 3.0f * direction_from_octahedral(
                    {2.0f * to_unit_float(hash(i, 0u)) - 1.0f, 2.0f * to_unit_float(hash(i, 1u)) - 1.0f});
}

std::vector<uint32_t> count_samples(const OctreeTree& tree, uint32_t points) {
  std::vector<uint32_t> counts(tree.leaf_slots(), 0);
  for (uint32_t i = 0; i < points; ++i) ++counts[tree.view().find(point_on_sphere(i))];
  return counts;
}

OctreeTree grown_tree(Backend& backend, uint32_t points) {
  OctreeTree tree(Vec3(0), 8);
  for (int frame = 0; frame < 12; ++frame) {
    const auto counts = count_samples(tree, points);
    tree = tree.adapted(backend, view_of(counts), {50, 100, 16});
  }
  return tree;
}

void bm_octree_find(benchmark::State& state) {
  Backend backend(1);
  const OctreeTree tree = grown_tree(backend, 100'000);
  const bool moving = state.range(0) != 0;
  std::vector<Vec3> points;
  for (uint32_t i = 0; i < 4096; ++i) points.push_back(point_on_sphere(i));
  uint32_t i = 0;
  for (auto _ : state) {
    const Vec3& p = points[i++ % 4096];
    benchmark::DoNotOptimize(tree.view().find_pair(moving ? p + Vec3(0.2f, 0, 0) : p, p));
  }
  state.counters["depth"] = tree.depth();
}
BENCHMARK(bm_octree_find)->ArgName("moving")->Arg(0)->Arg(1);

void bm_octree_adapt(benchmark::State& state) {
  Backend backend(1);
  const uint32_t points = static_cast<uint32_t>(state.range(0));
  const OctreeTree tree = grown_tree(backend, points);
  const auto counts = count_samples(tree, points);
  for (auto _ : state) benchmark::DoNotOptimize(tree.adapted(backend, view_of(counts), {50, 100, 16}).node_count());
  state.counters["leaves"] = tree.leaf_count();
}
BENCHMARK(bm_octree_adapt)->ArgName("samples")->Arg(10'000)->Arg(100'000);

}  // namespace
}  // namespace relume
