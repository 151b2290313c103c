#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <vector>

#include "core/stream_io.h"
#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"
#include "techniques/light_sampling/visibility_light_cache/exploration.h"
#include "testing/random.h"

namespace relume {
namespace {

/// A tree of eight regions, with given samples.
class Caches : public ::testing::Test {
 protected:
  void see(uint32_t region, LightId light, bool visible = true, int times = 1) {
    for (int i = 0; i < times; ++i) samples_.push_back({region, light | (visible ? kVisibleLight : 0u), 0, 0});
  }

  void build(const CacheBuildOptions& options = {}) {
    SampleStream stream;
    stream.resize(backend_, static_cast<uint32_t>(samples_.size()), 1);
    std::copy(samples_.begin(), samples_.end(), stream.samples().begin());
    stream.group(backend_, tree_.leaf_slots());
    caches_.build(backend_, tree_, stream.groups(), view_of(lights_), options);
    options_ = options;
    samples_.clear();
  }

  std::vector<LightId> known(uint32_t region) const {
    std::vector<LightId> ids;
    for (const uint32_t light : caches_.list(region)) ids.push_back(CachedLight::id(light));
    return ids;
  }

  /// Lights in the buckets; checks their buckets and order.
  std::vector<LightId> in_buckets(uint32_t region) const {
    const LightBuckets b = caches_.buckets()[region];
    std::vector<LightId> ids;
    for (uint32_t bucket = 0; bucket < b.count; ++bucket) {
      LightId last = 0;
      bool ended = false;
      for (uint32_t i = 0; i < options_.bucket_size; ++i) {
        const uint32_t entry = caches_.entries()[b.first + bucket * options_.bucket_size + i];
        if (entry == CachedLight::kNone) {
          ended = true;
          continue;
        }
        const LightId id = CachedLight::id(entry);
        EXPECT_FALSE(ended);
        EXPECT_EQ(id % b.count, bucket);
        EXPECT_TRUE(i == 0 || id > last);
        last = id;
        ids.push_back(id);
      }
    }
    std::sort(ids.begin(), ids.end());
    return ids;
  }

  static constexpr uint32_t kLights = 200000;

  Backend backend_{2};
  OctreeTree tree_{Vec3(0), 2};
  std::vector<LightSummary> lights_ = std::vector<LightSummary>(kLights);
  std::vector<VertexSample> samples_;
  LightCaches caches_;
  CacheBuildOptions options_;
};

TEST_F(Caches, KeepEachVisibleLightOnce) {
  see(0, 7, true, 5);
  see(0, 3, true, 2);
  see(0, 9, false, 4);
  see(0, 100000, true);
  build();
  EXPECT_EQ(known(0), (std::vector<LightId>{3, 7, 100000}));
  EXPECT_EQ(in_buckets(0), known(0));
  EXPECT_EQ(caches_.buckets()[0].count, 1u);
  EXPECT_EQ(caches_.dropped(), 0u);
}

TEST_F(Caches, OmitInfiniteAndRemovedLights) {
  CacheBuildOptions options;
  options.memory = 3;
  see(0, 7);
  see(0, kLights);
  build(options);
  EXPECT_EQ(known(0), (std::vector<LightId>{7}));
  SampleStream stream;
  stream.resize(backend_, 1, 1);
  stream.group(backend_, tree_.leaf_slots());
  caches_.build(backend_, tree_, stream.groups(), {lights_.data(), 7}, options);
  EXPECT_TRUE(known(0).empty());
}

TEST_F(Caches, WeightBucketsByEstimatedIrradiance) {
  CacheBuildOptions options;
  options.bucket_size = 4;
  // Region 0 is the cube from −1 to 0. Of four buckets, 0 has two lights inside, 1 has one 20 m away, and 2 is empty.
  lights_[0] = {Vec3(-0.5f), 3.0f};
  lights_[1] = {Vec3(-0.5f, -0.5f, -20.5f), 30.0f};
  lights_[3] = {Vec3(-0.5f), 0.0f};
  lights_[4] = lights_[0];
  for (const LightId light : {0u, 1u, 3u, 4u, 5u, 7u, 8u, 9u, 11u, 12u, 13u, 15u}) see(0, light);
  options.even_buckets = 0.5f;
  build(options);
  const LightBuckets b = caches_.buckets()[0];
  ASSERT_EQ(b.count, 4u);
  const float* weights = caches_.bucket_weights().data + b.first / options.bucket_size;
  // Twice 3 W at the least distance, half of the diagonal (√3 / 2 m), against 30 W at 20 m.
  const float near = 6 / 0.75f;
  const float far = 30 / 400.0f;
  EXPECT_NEAR(weights[0], 0.5f / 4 + 0.5f * near / (near + far), 1e-5f);
  EXPECT_NEAR(weights[1], 0.5f / 4 + 0.5f * far / (near + far), 1e-5f);
  EXPECT_EQ(weights[2], 0.0f);
  EXPECT_NEAR(weights[3], 0.5f / 2, 1e-5f);  // its own turn and that of bucket 2; its lights are dark
  for (const LightId light : {0u, 1u, 3u, 4u, 5u, 7u, 8u, 9u, 11u, 12u, 13u, 15u}) see(0, light);
  options.even_buckets = 1;
  build(options);
  const float* even = caches_.bucket_weights().data + caches_.buckets()[0].first / options.bucket_size;
  EXPECT_EQ(std::vector<float>(even, even + 4), (std::vector<float>{0.25f, 0.25f, 0.0f, 0.5f}));
}

TEST_F(Caches, PassTurnsOfEmptyBucketsAroundTheEnd) {
  CacheBuildOptions options;
  options.bucket_size = 2;
  options.even_buckets = 1;
  for (const LightId light : {0u, 8u, 2u, 10u, 4u, 12u}) see(0, light);  // buckets 0, 2 and 4 of eight
  build(options);
  const LightBuckets b = caches_.buckets()[0];
  ASSERT_EQ(b.count, 8u);
  const float* weights = caches_.bucket_weights().data + b.first / options.bucket_size;
  EXPECT_EQ(std::vector<float>(weights, weights + 8), (std::vector<float>{0.5f, 0, 0.25f, 0, 0.25f, 0, 0, 0}));
}

TEST_F(Caches, PassLightsOnToFaceNeighboursOnly) {
  see(0, 5);
  see(7, 6);
  build();
  EXPECT_EQ(known(1), (std::vector<LightId>{5}));
  EXPECT_EQ(known(3), (std::vector<LightId>{6}));
  EXPECT_EQ(known(7), (std::vector<LightId>{6}));  // across the corner from 0
  // Lights advance by one region per frame.
  build();
  for (uint32_t region = 0; region < 8; ++region) EXPECT_TRUE(known(region).empty());
}

TEST_F(Caches, UseTheFewestBucketsThatHoldAll) {
  CacheBuildOptions options;
  options.bucket_size = 8;
  for (LightId i = 0; i < 20; ++i) see(0, i);
  build(options);
  EXPECT_EQ(caches_.buckets()[0].count, 4u);  // three would suffice, but the number is a power of two
  EXPECT_EQ(in_buckets(0).size(), 20u);
  for (LightId i = 0; i < 9; ++i) see(0, 2 * i);  // all even: half of the buckets stay empty
  build(options);
  EXPECT_EQ(in_buckets(0).size(), 9u);
  EXPECT_EQ(caches_.buckets()[0].count, 4u);
}

TEST_F(Caches, KeepTheirBucketsUntilThereIsSpareRoom) {
  CacheBuildOptions options;
  options.bucket_size = 8;
  for (LightId i = 0; i < 9; ++i) see(0, i);
  build(options);
  ASSERT_EQ(caches_.buckets()[0].count, 2u);
  for (LightId i = 0; i < 8; ++i) see(0, i);  // exactly fill one bucket
  build(options);
  EXPECT_EQ(caches_.buckets()[0].count, 2u);
  for (LightId i = 0; i < 6; ++i) see(0, i);  // three quarters
  build(options);
  EXPECT_EQ(caches_.buckets()[0].count, 1u);
  for (LightId i = 0; i < 8; ++i) see(0, i);  // still fit
  build(options);
  EXPECT_EQ(caches_.buckets()[0].count, 1u);
}

TEST_F(Caches, DropAndCountExcessLights) {
  CacheBuildOptions options;
  options.bucket_size = 2;
  for (LightId i = 0; i < 500; ++i) see(0, i);
  build(options);
  EXPECT_EQ(in_buckets(0).size(), kMaxBuckets * 2u);
  EXPECT_GE(caches_.dropped(), 500u - kMaxBuckets * 2u);
  for (LightId i = 0; i < 3000; ++i) see(0, i);
  build();
  EXPECT_LE(known(0).size(), kMaxSeenLights);
  EXPECT_GT(caches_.dropped(), 0u);
}

TEST_F(Caches, RememberLightsForSomeFrames) {
  CacheBuildOptions options;
  options.memory = 2;
  see(0, 4);
  see(0, 8);
  build(options);
  for (int frame = 0; frame < 2; ++frame) {
    see(0, 8);
    build(options);
    EXPECT_EQ(known(0), (std::vector<LightId>{4, 8})) << frame;
  }
  see(0, 8);
  build(options);
  EXPECT_EQ(known(0), (std::vector<LightId>{8}));
}

TEST_F(Caches, SpreadALimitedNumberOfSamples) {
  CacheBuildOptions options;
  options.max_samples = 10;
  for (LightId i = 0; i < 100; ++i) see(0, i / 10);
  build(options);
  EXPECT_EQ(known(0).size(), 10u);  // one of every ten samples
}

TEST_F(Caches, AreInheritedByTheLeaves) {
  see(0, 5);
  see(7, 6);
  build();
  std::vector<uint32_t> counts(8, 10);
  counts[7] = 1000;
  const OctreeTree next = tree_.adapted(backend_, view_of(counts), {50, 100, 5});
  caches_.populate(backend_, next);
  ASSERT_EQ(next.leaf_slots(), 16u);
  EXPECT_EQ(known(0), (std::vector<LightId>{5}));
  for (uint32_t child = 8; child < 16; ++child) EXPECT_EQ(known(child), (std::vector<LightId>{6}));
  std::stringstream file;
  caches_.save(file);
  LightCaches other;
  other.load(file);
  EXPECT_EQ(other.list(9).size, 1u);
  std::string bytes = file.str();
  uint64_t read = 0;  // of all lists, so that sanitizers detect those out of range
  for (const size_t at : {size_t{0}, bytes.size() / 2, bytes.size() - 9}) {  // in lengths and in positions of lists
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    std::stringstream in(damaged);
    other.load(in);
    for (uint32_t region = 0; region < other.buckets().size; ++region) {
      for (const uint32_t light : other.list(region)) read += light;
    }
    RecordProperty("read", std::to_string(read));
  }
}

TEST_F(Caches, RejectListsThatOverlapMoreThanASplitCauses) {
  const auto loads = [](size_t regions) {
    std::stringstream file;
    write_vector(file, std::vector<LightBuckets>(regions));
    write_vector(file, std::vector<LightList>(regions, {0, 10}));
    write_vector(file, std::vector<uint32_t>(10, CachedLight::pack(1, 0)));
    write_vector(file, std::vector<uint32_t>());
    write_vector(file, std::vector<float>());
    write_vector(file, std::vector<LightShares>());
    LightCaches caches;
    caches.load(file);
    return static_cast<bool>(file);
  };
  EXPECT_TRUE(loads(8));
  EXPECT_FALSE(loads(9));
}

TEST_F(Caches, RefuseBucketsBeyondTheirEntries) {
  const auto loads = [](const LightBuckets& buckets, size_t entries, size_t weights) {
    std::stringstream file;
    write_vector(file, std::vector<LightBuckets>{buckets});
    write_vector(file, std::vector<LightList>(1));
    write_vector(file, std::vector<uint32_t>());
    write_vector(file, std::vector<uint32_t>(entries, CachedLight::kNone));
    write_vector(file, std::vector<float>(weights, 0.5f));
    write_vector(file, std::vector<LightShares>());
    LightCaches caches;
    caches.load(file);
    return static_cast<bool>(file);
  };
  EXPECT_TRUE(loads({32, 2}, 96, 3));
  EXPECT_FALSE(loads({64, 2}, 96, 3));
  EXPECT_FALSE(loads({33, 1}, 96, 3)) << "no bucket begins there";
  EXPECT_FALSE(loads({0, 1}, 96, 0));
  EXPECT_FALSE(loads({0, 1}, 97, 3));
}

TEST_F(Caches, DetectInconsistentBuckets) {
  const auto consistent = [](const std::vector<uint32_t>& entries, const std::vector<float>& weights) {
    std::stringstream file;
    write_vector(file, std::vector<LightBuckets>{{0, 2}});
    write_vector(file, std::vector<LightList>(1));
    write_vector(file, std::vector<uint32_t>());
    write_vector(file, entries);
    write_vector(file, weights);
    write_vector(file, std::vector<LightShares>());
    LightCaches caches;
    caches.load(file);
    return file && caches.consistent(2, 10);
  };
  const uint32_t none = CachedLight::kNone;
  const uint32_t nine = CachedLight::pack(9, 0);
  EXPECT_TRUE(consistent({nine, none, none, none}, {1, 0}));
  EXPECT_FALSE(consistent({nine, none, none, none}, {0.5f, 0.5f})) << "an empty bucket";
  EXPECT_FALSE(consistent({CachedLight::pack(10, 0), none, none, none}, {1, 0})) << "no such light";
  EXPECT_FALSE(consistent({nine, none, nine, none}, {1, 1}));
  EXPECT_FALSE(consistent({nine, none, nine, none}, {2, -1}));
  EXPECT_FALSE(consistent({nine, nine, nine, nine}, {std::nanf(""), 1}));
  EXPECT_FALSE(consistent({nine, none, none, none, none, none}, {1, 0})) << "buckets of three";
}

TEST_F(Caches, DoNotDependOnThreads) {
  for (int i = 0; i < 2; ++i) {  // eight regions would form one tile, run by one thread
    const std::vector<uint32_t> counts(tree_.leaf_slots(), 1000);
    tree_ = tree_.adapted(backend_, view_of(counts), {50, 100, 5});
  }
  ASSERT_GE(tree_.leaf_slots(), 512u);
  testing::Random random(1);
  std::vector<VertexSample> samples;
  for (int i = 0; i < 50000; ++i) {
    see(static_cast<uint32_t>(static_cast<float>(tree_.leaf_slots()) * random.next()),
        static_cast<uint32_t>(300 * sqr(random.next())), random.next() < 0.5f);
  }
  samples = samples_;
  build();
  const std::vector<uint32_t> entries(caches_.entries().begin(), caches_.entries().end());
  Backend one(1);
  SampleStream stream;
  stream.resize(one, static_cast<uint32_t>(samples.size()), 1);
  std::copy(samples.begin(), samples.end(), stream.samples().begin());
  stream.group(one, tree_.leaf_slots());
  LightCaches other;
  other.build(one, tree_, stream.groups(), view_of(lights_), {});
  EXPECT_EQ(std::vector<uint32_t>(other.entries().begin(), other.entries().end()), entries);
}

/// A point with a full BSDF below the lamps of the light scene.
SurfacePoint receiver(uint32_t region) {
  SurfacePoint sp{};
  sp.position = Vec3(0.2f, 0, 0.1f);
  sp.frame = make_frame(Vec3(0, 1, 0));
  sp.wo_local = glm::normalize(Vec3(0.3f, 0.1f, 0.8f));
  MaterialSample m;
  m.base_color = Rgb(0.6f);
  m.roughness = 0.4f;
  make_bsdf(sp.bsdf, m, MaterialData{}, energy_tables(), sp.wo_local.z, true);
  sp.region = region;
  return sp;
}

TEST(VisibilityLightCache, FavoursKnownAndImportantLights) {
  const testing::LightScene scene = testing::make_light_scene({});
  const LightsView& lights = scene.lights();
  const auto all = build_exploration(lights, Vec3(0), {});
  const auto infinite = build_infinite_lights(lights);
  const auto compact = compact_lights(lights);
  const std::vector<LightBuckets> buckets{{0, 1}, {0, 0}};
  std::vector<uint32_t> entries(32, CachedLight::kNone);
  entries[0] = CachedLight::pack(0, 0);
  entries[1] = CachedLight::pack(4, 0);
  VisibilityLightCache cache;
  cache.regions = view_of(buckets);
  const std::vector<float> bucket_weights{1};
  cache.entries = view_of(entries);
  cache.bucket_weights = view_of(bucket_weights);
  cache.all = {view_of(all)};
  const AliasTable explored{view_of(all)};
  cache.infinite = make_infinite_lights(lights, view_of(infinite), true);
  cache.ltc = ltc_table();
  cache.compact = view_of(compact);
  cache.lights = lights;
  const SurfacePoint sp = receiver(0);
  const float finite = 1 - cache.infinite.share;
  EXPECT_NEAR(cache.pmf(sp, 0) + cache.pmf(sp, 4), finite * (0.9f + 0.1f * (explored.pmf(0) + explored.pmf(4))), 1e-5f);
  EXPECT_NEAR(cache.pmf(sp, 1), finite * 0.1f * explored.pmf(1), 1e-6f);  // reached by exploration only
  const LightReceiver r = make_light_receiver(cache.ltc, sp.position, sp.frame, sp.wo_local, sp.bsdf);
  const auto cached = [&](LightId id) { return cache.pmf(sp, id) - finite * 0.1f * explored.pmf(id); };
  EXPECT_NEAR(cached(0) / cached(4),
              light_importance_of(r, lights, cache.compact, 0) / light_importance_of(r, lights, cache.compact, 4),
              1e-3f);
  // Without a list or outside all regions, exploration decides alone.
  for (const uint32_t region : {1u, 2u, kNoRegion}) {
    EXPECT_NEAR(cache.pmf(receiver(region), 0), finite * explored.pmf(0), 1e-6f);
  }
}

}  // namespace
}  // namespace relume
