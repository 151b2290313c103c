// The grid of light vertices, the number of light subpaths and the radius.
#include "techniques/transport/vcm/merging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "frame/primitives/group_by_key.h"
#include "techniques/transport/vcm/vcm_pass.h"

namespace relume {
namespace {

PathVertex vertex_at(const Vec3& position, bool connectable) {
  PathVertex v{};
  v.position = position;
  v.throughput = connectable ? Rgb(1) : Rgb(0);
  return v;
}

float random(uint32_t i, uint32_t k) { return to_unit_float(hash(i, k)); }

/// Compares the vertices found around random points with all vertices. With few buckets, most contain several cells,
/// and many rows continue from the last bucket at the first.
void expect_all_near(uint32_t bucket_count) {
  constexpr float kRadius = 0.1f;
  constexpr uint32_t kVertices = 1000;
  const MergeGrid grid{Vec3(0.5f), 0.5f / kRadius, bucket_count};
  std::vector<PathVertex> vertices;
  std::vector<uint32_t> keys;
  for (uint32_t i = 0; i < kVertices; ++i) {
    vertices.push_back(vertex_at({random(i, 1), random(i, 2), random(i, 3)}, hash(i, 4u) % 8 != 0));
    keys.push_back(grid.key_of(vertices.back()));
  }
  Backend backend(1);
  PrimitiveScratch scratch;
  KeyGroups groups;
  const Elements<uint32_t> by_vertex{view_of(keys)};
  ASSERT_TRUE(group_by_key({backend, "test", scratch}, by_vertex, kVertices, grid.buckets, groups));
  std::vector<SortedVertex> sorted;
  for (const uint32_t i : groups.order.read()) sorted.push_back({vertices[i].position, i});
  const SortedVertices near{view_of(sorted), groups.begins.view(), grid, sqr(kRadius)};

  size_t pairs = 0;
  for (uint32_t query = 0; query < 100; ++query) {
    const Vec3 p(random(query, 5), random(query, 6), random(query, 7));
    std::vector<uint32_t> expected;
    for (uint32_t i = 0; i < kVertices; ++i) {
      if (vertices[i].connectable() && length_squared(vertices[i].position - p) < sqr(kRadius)) expected.push_back(i);
    }
    std::vector<uint32_t> found;
    near.for_each_near(p, [&](uint32_t vertex) { found.push_back(vertex); });
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 100u);
}

TEST(MergeGrid, FindsEveryVertexWithinTheRadiusOnce) {
  for (const uint32_t bucket_count : {2u, 4u, 16u, 1024u}) {
    SCOPED_TRACE(bucket_count);
    expect_all_near(bucket_count);
  }
}

TEST(VcmSettings, MemoryLimitsTheNumberOfLightSubpaths) {
  VcmSettings settings;
  EXPECT_EQ(light_paths_of(settings, 100, 8), 100u);
  settings.pixels_per_path = 3;
  EXPECT_EQ(light_paths_of(settings, 100, 8), 33u);
  EXPECT_EQ(light_paths_of(settings, 2, 8), 1u);
  settings.pixels_per_path = 1;
  settings.memory_mib = 1;
  const uint64_t few = light_paths_of(settings, 1'000'000, 8);
  EXPECT_LT(few * 8 * sizeof(PathVertex), uint64_t{1} << 20);
  EXPECT_GT(few, 500u);
  EXPECT_GT(light_paths_of(settings, 1'000'000, 2), 3 * few);
  EXPECT_GE(light_paths_of(settings, 1'000'000, kMaxLightVertices - 1), 1u);
}

TEST(VcmSettings, TheRadiusShrinksByThePowerOfTheFrame) {
  VcmSettings settings;
  settings.radius = 0.01f;
  settings.alpha = 0.5f;
  EXPECT_FLOAT_EQ(merging_radius(settings, 5.0f, 0), 0.05f);
  EXPECT_FLOAT_EQ(merging_radius(settings, 5.0f, 15), 0.025f);  // r_16² = r_1² / √16
  settings.alpha = 1;
  EXPECT_FLOAT_EQ(merging_radius(settings, 5.0f, 15), 0.05f);
}

}  // namespace
}  // namespace relume
