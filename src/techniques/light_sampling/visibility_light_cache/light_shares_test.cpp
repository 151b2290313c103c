#include "techniques/light_sampling/visibility_light_cache/learn_shares.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <vector>

namespace relume {
namespace {

/// Caches of eight regions whose last light is a sun.
class Shares : public ::testing::Test {
 protected:
  static constexpr LightId kSun = 20;

  Shares() { options_.first_infinite = kSun; }

  void see(uint32_t region, LightId light, bool visible, int times) {
    for (int i = 0; i < times; ++i) samples_.push_back({region, light | (visible ? kVisibleLight : 0u), 0, 0});
  }

  void build() {
    SampleStream stream;
    stream.resize(backend_, static_cast<uint32_t>(samples_.size()), 1);
    std::copy(samples_.begin(), samples_.end(), stream.samples().begin());
    stream.group(backend_, tree_.leaf_slots());
    caches_.build(backend_, tree_, stream.groups(), view_of(lights_), options_);
    samples_.clear();
  }

  std::vector<LightId> known(uint32_t region) const {
    std::vector<LightId> ids;
    for (const uint32_t light : caches_.list(region)) ids.push_back(CachedLight::id(light));
    return ids;
  }

  Backend backend_{2};
  OctreeTree tree_{Vec3(0), 2};
  std::vector<LightSummary> lights_ = std::vector<LightSummary>(kSun + 1);
  std::vector<VertexSample> samples_;
  LightCaches caches_;
  CacheBuildOptions options_;
};

TEST_F(Shares, SunsAreListedWithTheirVisibility) {
  for (int frame = 0; frame < 8; ++frame) {
    see(0, kSun, true, 30);
    see(0, kSun, false, 90);
    see(0, 5, true, 40);       // a finite light does not count
    see(7, kSun, false, 200);  // a region without windows, across the corner from 0
    see(7, 6, true, 10);
    build();
  }
  EXPECT_EQ(known(0), (std::vector<LightId>{5, kSun}));
  EXPECT_EQ(known(7), (std::vector<LightId>{6}));
  ASSERT_EQ(caches_.shares().size, tree_.leaf_slots());
  EXPECT_NEAR(caches_.shares()[0].visibility.of[0], 0.25f, 0.01f);
  EXPECT_LT(caches_.shares()[7].visibility.of[0], 0.01f);
  EXPECT_EQ(caches_.shares()[0].visibility.of[1], 0.5f);  // no such light
  caches_.populate(backend_, tree_);
  EXPECT_LT(caches_.shares()[7].visibility.of[0], 0.01f);
}

TEST_F(Shares, CountRecordsByTheirWeight) {
  options_.exploration = {.learns = true, .start = 0.1f, .floor = 0.02f};
  see(0, kSun, true, 10);
  for (VertexSample& s : samples_) s.weight = 3.5f;
  see(0, kSun, false, 65);
  see(1, kSun, true, 35);
  see(1, kSun, false, 65);
  see(7, kSun, true, 10);
  for (VertexSample& s : samples_) s.weight = s.region == 7 ? 0 : s.weight;  // culled
  build();
  EXPECT_FLOAT_EQ(caches_.shares()[0].visibility.of[0], caches_.shares()[1].visibility.of[0]);
  EXPECT_NE(caches_.shares()[0].visibility.of[0], 0.5f);
  EXPECT_FLOAT_EQ(caches_.shares()[0].exploration, caches_.shares()[1].exploration);
  EXPECT_EQ(caches_.shares()[7].visibility.of[0], 0.5f);
  EXPECT_EQ(known(7), std::vector<LightId>{});
}

TEST_F(Shares, ArePartOfCheckpoints) {
  see(0, kSun, true, 30);
  build();
  std::stringstream file;
  caches_.save(file);
  LightCaches other;
  other.load(file);
  EXPECT_TRUE(file);
  ASSERT_EQ(other.shares().size, tree_.leaf_slots());
  EXPECT_EQ(other.shares()[0].visibility.of[0], caches_.shares()[0].visibility.of[0]);
  LightShares damaged;
  damaged.visibility.of[2] = 0;
  EXPECT_FALSE(damaged.valid());
}

TEST_F(Shares, ExplorationFollowsTheRateOfNewLights) {
  options_.exploration = {.learns = true, .start = 0.1f, .floor = 0.02f};
  const auto exploration = [&](uint32_t region) { return caches_.shares()[region].exploration; };
  see(0, 1, true, 200);
  build();
  EXPECT_FLOAT_EQ(exploration(0), 0.5f);  // without a list, all is new
  EXPECT_FLOAT_EQ(exploration(7), 0.1f);  // no samples
  for (int frame = 0; frame < 8; ++frame) {
    see(0, 1, true, 200);
    see(0, 2, false, 300);  // hidden
    build();
  }
  EXPECT_FLOAT_EQ(exploration(0), 0.02f);
  for (int i = 0; i < 10; ++i) see(0, static_cast<LightId>(5 + i), true, 1);
  see(0, 1, true, 200);
  build();
  EXPECT_GT(exploration(0), 0.2f);
  for (int frame = 0; frame < 8; ++frame) {  // now they are on the list
    for (int i = 0; i < 10; ++i) see(0, static_cast<LightId>(5 + i), true, 20);
    build();
  }
  EXPECT_FLOAT_EQ(exploration(0), 0.02f);
  EXPECT_FLOAT_EQ(exploration(7), 0.1f);
}

TEST_F(Shares, EndWithTheListing) {
  build();
  EXPECT_FALSE(caches_.shares().empty());
  options_.first_infinite = kNoLight;
  build();
  EXPECT_TRUE(caches_.shares().empty());
}

TEST_F(Shares, WeightBucketsByIrradianceFromInfinity) {
  options_.bucket_size = 1;
  options_.even_buckets = 0.5f;
  options_.scene_radius = 2;
  lights_[kSun].watts = 8;           // 2 W/m², times the visibility
  lights_[5] = {Vec3(-0.5f), 3.0f};  // in region 0, at the least distance √3 / 2
  see(0, kSun, true, 3000);
  see(0, 5, true, 100);
  build();
  const LightBuckets b = caches_.buckets()[0];
  ASSERT_EQ(b.count, 2u);
  const float* weights = caches_.bucket_weights().data + b.first;
  const float sun = 2 * caches_.shares()[0].visibility.of[0];
  EXPECT_GT(sun, 1.9f);
  EXPECT_NEAR(weights[0], 0.25f + 0.5f * sun / (sun + 3 / 0.75f), 1e-5f);
  EXPECT_NEAR(weights[1], 0.25f + 0.5f * (3 / 0.75f) / (sun + 3 / 0.75f), 1e-5f);
}

}  // namespace
}  // namespace relume
