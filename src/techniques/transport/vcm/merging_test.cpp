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

TEST(MergeGrid, FindsEveryVertexWithinTheRadiusOnce) {
  constexpr float kRadius = 0.1f;
  constexpr uint32_t kStride = 4;
  constexpr uint32_t kPaths = 500;
  std::vector<PathVertex> vertices;
  std::vector<uint32_t> counts;
  for (uint32_t path = 0; path < kPaths; ++path) {
    counts.push_back(hash(path, 9u) % (kStride + 1));
    for (uint32_t k = 0; k < kStride; ++k) {
      const uint32_t i = path * kStride + k;
      vertices.push_back(vertex_at({random(i, 1), random(i, 2), random(i, 3)}, hash(i, 4u) % 8 != 0));
    }
  }
  // Few buckets, so that most of them contain several cells.
  const MergeGrid grid{Vec3(0.5f), 0.5f / kRadius, 16};
  const VertexBuckets buckets{view_of(vertices), view_of(counts), kStride, grid};
  Backend backend(1);
  PrimitiveScratch scratch;
  KeyGroups groups;
  ASSERT_TRUE(group_by_key({backend, "test", scratch}, buckets, kPaths * kStride, grid.buckets, groups));
  const auto order = groups.order.read();
  const auto begins = groups.begins.read();

  size_t pairs = 0;
  for (uint32_t query = 0; query < 100; ++query) {
    const Vec3 p(random(query, 5), random(query, 6), random(query, 7));
    std::vector<uint32_t> expected;
    for (uint32_t i = 0; i < vertices.size(); ++i) {
      const bool exists = i % kStride < counts[i / kStride] && vertices[i].connectable();
      if (exists && length_squared(vertices[i].position - p) < sqr(kRadius)) expected.push_back(i);
    }
    std::vector<uint32_t> found;
    const GridCell first = grid.cell_at(p, 0.5f);
    for (int32_t i = 0; i < 8; ++i) {
      const GridCell cell{first.x + (i & 1), first.y + ((i >> 1) & 1), first.z + (i >> 2)};
      const uint32_t bucket = grid.bucket_of(cell);
      for (uint32_t k = begins[bucket]; k < begins[bucket + 1]; ++k) {
        const Vec3& at = vertices[order[k]].position;
        if (grid.cell_at(at) == cell && length_squared(at - p) < sqr(kRadius)) found.push_back(order[k]);
      }
    }
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, expected);
    pairs += expected.size();
  }
  EXPECT_GT(pairs, 100u);
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
