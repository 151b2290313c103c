// The forms of the kernel that deduplicates lights give the same bits; both sort any list.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

#include "frame/launch.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "testing/group_emulation.h"
#include "testing/random.h"

namespace relume {
namespace {

constexpr uint32_t kLights = 5000;  ///< ids from this one on are ignored

/// A region's samples: their number, and the number of lights that they are drawn from.
struct Region {
  uint32_t samples;
  uint32_t lights;
};

/// Samples grouped by region, and the output of the kernel.
struct Scene {
  explicit Scene(const std::vector<Region>& regions) {
    testing::Random random(1);
    for (const Region& region : regions) {
      offsets.push_back(static_cast<uint32_t>(records.size()));
      counts.push_back(region.samples);
      for (uint32_t i = 0; i < region.samples; ++i) {
        VertexSample sample;
        sample.light = static_cast<uint32_t>(random.next() * static_cast<float>(region.lights)) | kVisibleLight;
        if (i % 11 == 3) sample.light &= ~kVisibleLight;
        if (i % 13 == 4) sample.light = kNoLight;
        records.push_back(sample);
      }
    }
    offsets.push_back(static_cast<uint32_t>(records.size()));
    order.resize(records.size());
    std::iota(order.begin(), order.end(), 0u);
    seen.assign(records.size(), 77);
    seen_counts.assign(counts.size(), 77);
  }

  DeduplicateLightsKernel kernel(uint32_t max_samples) {
    return {{view_of(records), view_of(order), view_of(offsets), view_of(counts)},
            kLights,
            max_samples,
            mutable_view_of(seen),
            mutable_view_of(seen_counts),
            mutable_view_of(dropped)};
  }
  bool same_output(const Scene& other) const {
    return seen == other.seen && seen_counts == other.seen_counts && dropped == other.dropped;
  }

  std::vector<VertexSample> records;
  std::vector<uint32_t> order;
  std::vector<uint32_t> offsets;
  std::vector<uint32_t> counts;
  std::vector<uint32_t> seen;
  std::vector<uint32_t> seen_counts;
  std::vector<uint64_t> dropped = {0};
};

TEST(DeduplicateLights, FormsAgree) {
  const std::vector<Region> regions = {{0, 1},     {1, 1},       {2, 5000},    {7, 3},       {127, 40},    {128, 5000},
                                       {129, 200}, {900, 1},     {1024, 5000}, {1025, 9000}, {1300, 9000}, {4096, 700},
                                       {0, 1},     {6000, 1020}, {5000, 1026}, {9000, 9000}};
  for (const uint32_t max_samples : {1u, 100u, 4096u, 1u << 24}) {
    std::vector<Scene> scenes(3, Scene(regions));
    const auto count = static_cast<uint32_t>(regions.size());
    for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
      Backend backend(1, form);
      launch(backend, "deduplicate", scenes[form == KernelForm::host ? 0 : 1].kernel(max_samples), count, 1);
    }
    testing::run_shuffled(scenes[2].kernel(max_samples), count, 1, max_samples);
    EXPECT_TRUE(scenes[0].same_output(scenes[1])) << max_samples;
    EXPECT_TRUE(scenes[0].same_output(scenes[2])) << max_samples;
    EXPECT_EQ(scenes[0].dropped[0] > 0, max_samples >= 4096) << max_samples;
  }
}

TEST(DeduplicateLights, FormsAgreeOnThreads) {
  std::vector<Scene> scenes(2, Scene({{1, 1}, {300, 40}, {2000, 9000}}));
  Backend backend(1);
  launch(backend, "deduplicate", scenes[0].kernel(4096), 3, 1);
  testing::run_threaded(scenes[1].kernel(4096), 3, 1);
  EXPECT_TRUE(scenes[0].same_output(scenes[1]));
}

TEST(DeduplicateLights, WritesTheDistinctVisibleLightsInOrder) {
  Scene scene({{500, 90}, {300, 9000}});
  testing::run_shuffled(scene.kernel(4096), 2, 1, 1);
  for (const uint32_t region : {0u, 1u}) {
    std::set<uint32_t> expected;
    for (uint32_t i = scene.offsets[region]; i < scene.offsets[region + 1]; ++i) {
      const uint32_t light = scene.records[i].light;
      const bool visible = light != kNoLight && (light & kVisibleLight) != 0;
      if (visible && (light & ~kVisibleLight) < kLights) expected.insert(light & ~kVisibleLight);
    }
    const auto first = scene.seen.begin() + scene.offsets[region];
    EXPECT_EQ(std::vector<uint32_t>(first, first + scene.seen_counts[region]),
              std::vector<uint32_t>(expected.begin(), expected.end()));
  }
}

TEST(LightSet, SortsAnything) {
  testing::Random random(2);
  for (uint32_t count = 0; count < 70; ++count) {
    std::vector<uint32_t> values;
    for (uint32_t i = 0; i < count; ++i) values.push_back(static_cast<uint32_t>(100 * random.next()));
    std::vector<uint32_t> expected = values;
    std::sort(expected.begin(), expected.end());
    light_cache::sort(values.data(), count);
    EXPECT_EQ(values, expected);
  }
}

}  // namespace
}  // namespace relume
