#include "techniques/spatial/octree/useful_samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "frame/launch.h"
#include "techniques/spatial/octree/octree_pass.h"

namespace relume {
namespace {

constexpr LightId kFirstInfinite = 10;

/// Three regions: lights, some of them hidden or at infinity; directions, some without light; nothing useful but the
/// importance of every third record.
std::vector<uint32_t> count(const RecordUsers& users, KernelForm form) {
  std::vector<VertexSample> records;
  const auto add = [&](uint32_t region, uint32_t light, float value, int times) {
    for (int i = 0; i < times; ++i) records.push_back({.region = region, .light = light, .value = value});
  };
  add(0, 3 | kVisibleLight, 0, 200);
  add(0, 4, 0, 40);  // hidden
  add(0, kFirstInfinite | kVisibleLight, 0, 20);
  add(0, kNoLight, 1, 50);
  add(1, kNoLight, 0, 30);
  add(1, 5 | kVisibleLight, 2, 7);
  add(1, kNoLight, 3, 9);
  add(2, kNoLight, 0, 300);
  Backend backend(2);
  SampleStream stream;
  stream.resize(backend, static_cast<uint32_t>(records.size()), 1, true);
  std::copy(records.begin(), records.end(), stream.samples().begin());
  for (size_t i = 0; i < records.size(); ++i)
    stream.importance().data[i] = {0, records[i].region == 2 && i % 3 == 0 ? 0.5f : 0.0f};
  stream.group(backend, 3);
  std::vector<uint32_t> useful(3, 99);
  const CountUsefulSamplesKernel kernel{stream.groups(), users, kFirstInfinite, mutable_view_of(useful)};
  for (uint32_t region = 0; region < 3; ++region) run_group(kernel, region, 0, form);
  return useful;
}

TEST(UsefulSamples, CountForTheEstimatorThatUsesMost) {
  for (const KernelForm form : {KernelForm::host, KernelForm::device}) {
    EXPECT_EQ(count({true, false, true}, form), (std::vector<uint32_t>{200, 16, 0}));
    EXPECT_EQ(count({true, true, true}, form), (std::vector<uint32_t>{220, 16, 0}));
    EXPECT_EQ(count({true, false, false}, form), (std::vector<uint32_t>{200, 7, 0}));
    EXPECT_EQ(count({false, false, true}, form), (std::vector<uint32_t>{50, 16, 0}));
    EXPECT_EQ(count({true, false, true, true}, form), (std::vector<uint32_t>{200, 16, 100}));
  }
}

TEST(UsefulSamples, HaveThresholdsThatDoNotScale) {
  OctreeSettings settings;
  EXPECT_EQ(thresholds_of(settings, 1920 * 1080).split, 4096u);
  EXPECT_EQ(thresholds_of(settings, 128 * 72).split, 1024u);
  settings.count = OctreeCount::useful;
  for (const uint32_t pixels : {128u * 72u, 3840u * 2160u}) {
    EXPECT_EQ(thresholds_of(settings, pixels).split, 4096u);
    EXPECT_EQ(thresholds_of(settings, pixels).collapse, 2048u);
  }
}

}  // namespace
}  // namespace relume
