// Tests the records for learning of paths whose parts a cache replaces: those of paths without a cache, in expectation.
#include <gtest/gtest.h>

#include <array>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "core/octahedral.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume {
namespace {

using testing::CachedFrames;
using testing::CachedFrameSettings;
using testing::CacheKind;

constexpr int kBounces = 5;

CachedFrameSettings recorded(CacheKind kind, int size) {
  CachedFrameSettings s;
  s.kind = kind;
  s.width = s.height = size;
  s.max_bounces = kBounces;
  s.russian_roulette = false;
  s.apsf.min_samples = 16;
  s.recorded = true;
  return s;
}

/// A closed furnace with walls of albedo one half below a smooth coat.
Scene coated_furnace() {
  Scene scene = testing::closed_furnace(0.5f);
  scene.materials[0].clearcoat = 1;
  scene.materials[0].clearcoat_roughness = 0;
  return scene;
}

/// A closed furnace in which a plate fills the image. The plate's narrow lobe gets no cell.
Scene furnace_with_metal() {
  Scene scene = testing::closed_furnace(0.5f);
  Material metal;
  metal.base_color = Rgb(0.9f);
  metal.roughness = 0.15f;
  testing::add_mesh(scene, metal, quad({-0.95f, -0.95f, -0.5f}, {1.9f, 0, 0}, {0, 1.9f, 0}));
  return scene;
}

/// Sums over the records of one vertex in many frames.
struct RecordSums {
  double weights = 0;
  double values = 0;      ///< weight · value
  double squares = 0;     ///< weight · value²
  double radiance = 0;    ///< incident radiance, if the surface faces +Z; densities are rounded
  double directions = 0;  ///< number of records with a direction
  uint64_t culled = 0;
  uint64_t pixels = 0;

  void add(const VertexSample& s) {
    ++pixels;
    if (s.region == kNoRegion) return;
    if (!(s.weight > 0.0f)) {
      ++culled;
      EXPECT_EQ(s.light, kNoLight);
      EXPECT_EQ(s.value, 0.0f);
      return;
    }
    EXPECT_GE(s.weight, 1.0f);
    const auto weight = static_cast<double>(s.weight);
    const auto value = static_cast<double>(s.value);
    weights += weight;
    values += weight * value;
    squares += weight * value * value;
    if (s.densities == 0) return;
    const Vec3 w = direction_from_square(unpack_square(s.direction));
    radiance += value * static_cast<double>(unpack_density(s.densities) / w.z);
    ++directions;
  }
  double mean_weight() const { return weights / static_cast<double>(pixels); }
  double mean_value() const { return values / static_cast<double>(pixels); }
};

using Records = std::array<RecordSums, CachedFrames::kRecordedVertices>;

Records record(Scene scene, const CachedFrameSettings& settings, int frames) {
  CachedFrames cached(std::move(scene), settings);
  Records records;
  for (int frame = 0; frame < frames; ++frame) {
    cached.render();
    const size_t pixels = cached.records().size() / records.size();
    for (size_t i = 0; i < cached.records().size(); ++i) records[i / pixels].add(cached.records()[i]);
  }
  return records;
}

/// Mean value at vertex v of paths without a cache in the furnace. Paths follow the cosine, and emission is left to
/// next event estimation: a value is π times the light that the next vertex reflects in the bounces that remain.
double furnace_value(uint32_t v) {
  return static_cast<double>(kPi) * (testing::closed_furnace_radiance(0.5, kBounces - 1 - static_cast<int>(v)) - 1);
}

/// Score of a chain's new state; 0 without one.
template <typename ChainState>
float score_of(const MarkovRecord<ChainState>& record) {
  return record.cells[0].slot == kNoSlot ? 0.0f : record.state.weight;
}

class RecordedPaths : public ::testing::TestWithParam<CacheKind> {};

/// Compares samples for reservoirs, and returns the number of samples with light.
size_t expect_samples(const std::vector<IndirectSample>& cached, const std::vector<IndirectSample>& plain) {
  size_t lit = 0;
  EXPECT_EQ(cached.size(), plain.size());
  for (size_t i = 0; i < plain.size(); ++i) {
    const IndirectSample& a = cached[i];
    const IndirectSample& b = plain[i];
    EXPECT_EQ(a.vertex.instance, b.vertex.instance) << i;
    EXPECT_EQ(a.vertex.primitive, b.vertex.primitive) << i;
    EXPECT_NEAR(a.weight, b.weight, 1e-3f * b.weight) << i;
    const float light = luminance(b.vertex.radiance);
    EXPECT_NEAR(luminance(a.vertex.radiance), light, 3e-3f * (1 + light)) << i;
    lit += light > 0.01f ? 1 : 0;
  }
  return lit;
}

/// Compares the records of a frame, in which cells are empty, with those of paths without a cache.
void expect_records_of_paths(const CachedFrameSettings& settings) {
  CachedFrameSettings without = settings;
  without.kind = CacheKind::none;
  without.sampled = false;
  Scene coated = find_builtin_scene("cornell")->build();
  for (Material& m : coated.materials) {
    m.clearcoat = 1;
    m.clearcoat_roughness = 0;
  }
  for (const Scene& scene : {coated, find_builtin_scene("cornell-spheres")->build()}) {
    CachedFrames cached(scene, settings);
    CachedFrames plain(scene, without);
    cached.trace();
    plain.trace();
    ASSERT_EQ(cached.records().size(), plain.records().size());
    size_t compared = 0;
    size_t lit = 0;
    for (size_t i = 0; i < plain.records().size(); ++i) {
      const VertexSample& a = cached.records()[i];
      const VertexSample& b = plain.records()[i];
      ASSERT_EQ(a.region, b.region) << i;
      ASSERT_EQ(a.light, b.light) << i;
      ASSERT_EQ(a.direction, b.direction) << i;
      ASSERT_EQ(a.densities, b.densities) << i;
      ASSERT_EQ(a.weight, 1.0f) << i;
      ASSERT_NEAR(a.value, b.value, 3e-3f * (1 + b.value)) << i;
      const float towards = score_of(plain.directions()[i]);
      ASSERT_NEAR(score_of(cached.directions()[i]), towards, 3e-3f * (1 + towards)) << i;
      const float light = score_of(plain.lights()[i]);
      ASSERT_NEAR(score_of(cached.lights()[i]), light, 3e-3f * (1 + light)) << i;
      compared += b.value > 0.01f && towards > 0.0f ? 1 : 0;
      lit += light > 0.0f ? 1 : 0;
    }
    EXPECT_GT(lit, plain.records().size() / 20);
    EXPECT_GT(compared, plain.records().size() / 20);
    if (!settings.sampled) continue;
    without.sampled = true;
    CachedFrames sampling(scene, without);
    without.sampled = false;
    sampling.trace();
    EXPECT_GT(expect_samples(cached.samples(), sampling.samples()), sampling.samples().size() / 20);
  }
}

/// Without cells, caches only change the units of paths.
TEST_P(RecordedPaths, EqualThoseWithoutACacheWhileCellsAreEmpty) { expect_records_of_paths(recorded(GetParam(), 48)); }

/// With empty cells, samples for reservoirs also equal those without a cache, whether the cache rebases the path before
/// or after the sample is taken.
TEST_P(RecordedPaths, EqualThoseWithoutACacheBesideSamplesForReservoirs) {
  CachedFrameSettings settings = recorded(GetParam(), 48);
  settings.sampled = true;
  expect_records_of_paths(settings);
}

/// Sums over frames whose paths leave light to reservoirs.
struct SampledMeans {
  Records records;
  double light = 0;  ///< mean light of a pixel's sample
  double image = 0;  ///< mean of the image without this light
};

SampledMeans sampled_means(Scene scene, CacheKind kind) {
  constexpr int kFrames = 200;
  CachedFrameSettings settings = recorded(kind, 24);
  settings.sampled = true;
  CachedFrames cached(std::move(scene), settings);
  SampledMeans means;
  for (int frame = 0; frame < kFrames; ++frame) {
    cached.render();
    const size_t pixels = cached.samples().size();
    for (size_t i = 0; i < cached.records().size(); ++i) means.records[i / pixels].add(cached.records()[i]);
    for (const IndirectSample& s : cached.samples())
      means.light += static_cast<double>(luminance(s.vertex.radiance)) / static_cast<double>(pixels * kFrames);
    for (const Rgb& p : cached.radiance())
      means.image += static_cast<double>(luminance(p)) / static_cast<double>(pixels * kFrames);
  }
  return means;
}

/// With cells, in a furnace: the light of each sample and vertex, and the pixels without the light of samples.
TEST_P(RecordedPaths, HaveTheAnalyticMeanBesideSamplesForReservoirs) {
  const SampledMeans means = sampled_means(testing::closed_furnace(0.5f), GetParam());
  EXPECT_NEAR(means.records[0].mean_value() / furnace_value(0), 1.0, 0.05);
  EXPECT_NEAR(means.records[1].mean_value() / furnace_value(1), 1.0, 0.05);
  EXPECT_NEAR(means.light, testing::closed_furnace_radiance(0.5, kBounces - 1) - 1, 0.03);
  EXPECT_NEAR(means.image, 1.5, 0.03) << "emission and its reflection";
}

/// Where delta lobes bypass cells.
TEST_P(RecordedPaths, HaveTheMeanOfSamplesBelowACoat) {
  static const SampledMeans expected = sampled_means(coated_furnace(), CacheKind::none);
  const SampledMeans means = sampled_means(coated_furnace(), GetParam());
  EXPECT_NEAR(means.light / expected.light, 1.0, 0.03);
  EXPECT_NEAR(means.image / expected.image, 1.0, 0.03);
}

/// Where primary hits have no cells in any cache.
TEST_P(RecordedPaths, HaveTheMeanOfSamplesBehindNarrowLobes) {
  static const SampledMeans expected = sampled_means(furnace_with_metal(), CacheKind::none);
  const SampledMeans means = sampled_means(furnace_with_metal(), GetParam());
  EXPECT_NEAR(means.light / expected.light, 1.0, 0.03);
  EXPECT_NEAR(means.image / expected.image, 1.0, 0.03);
}

TEST_P(RecordedPaths, HaveTheAnalyticMeanInAFurnace) {
  constexpr int kFrames = 400;
  const bool culls = GetParam() == CacheKind::apsf || GetParam() == CacheKind::apsf_apg;
  const bool graph = GetParam() == CacheKind::apg || GetParam() == CacheKind::apsf_apg;
  for (const float constant : {0.1f, 0.0f}) {
    CachedFrameSettings settings = recorded(GetParam(), 24);
    settings.apg.variance_constant = constant;
    const Records records = record(testing::closed_furnace(0.5f), settings, kFrames);
    // 230,000 paths. If one in 18 is traced beyond its first vertex, as by an adaptive graph with a constant of zero,
    // the standard error is 0.9 %. Means of cells are biased by at most 1 %.
    EXPECT_NEAR(records[0].mean_weight(), 1.0, 0.04) << constant;
    EXPECT_NEAR(records[0].mean_value() / furnace_value(0), 1.0, 0.05) << constant;
    EXPECT_NEAR(records[1].mean_value() / furnace_value(1), 1.0, 0.05) << constant;
    if (culls || (graph && constant == 0.0f)) {
      EXPECT_GT(records[0].culled, 10000u) << constant;
    } else {
      EXPECT_EQ(records[0].culled, 0u) << constant;
    }
    if (!graph) break;
  }
}

/// Chains score directions by the light that regions record: means of cells, too. In a furnace of albedo ρ whose
/// directions follow the cosine, a score is ρ/π times the value. Vertices at which paths end have neither.
TEST_P(RecordedPaths, TeachChainsTheSameLight) {
  constexpr float kAlbedo = 0.5f;
  CachedFrames cached(testing::closed_furnace(kAlbedo), recorded(GetParam(), 24));
  size_t ended = 0;
  for (int frame = 0; frame < 24; ++frame) {
    cached.render();
    for (size_t i = 0; i < cached.records().size(); ++i) {
      const VertexSample& sample = cached.records()[i];
      ASSERT_NEAR(score_of(cached.directions()[i]), kAlbedo / kPi * sample.value, 1e-3f) << i;
      if (sample.weight > 0.0f) continue;
      ASSERT_EQ(score_of(cached.directions()[i]), 0.0f) << i;
      ASSERT_EQ(score_of(cached.lights()[i]), 0.0f) << i;
      ++ended;
    }
  }
  if (GetParam() == CacheKind::apsf || GetParam() == CacheKind::apsf_apg) {
    EXPECT_GT(ended, 100u) << "no path ended in a cell";
  }
}

TEST_P(RecordedPaths, HaveTheMeanWithoutACacheBelowACoat) {
  constexpr int kFrames = 400;
  // Recorded once for all caches.
  static const double expected = record(coated_furnace(), recorded(CacheKind::none, 24), kFrames)[0].mean_value();
  const double mean = record(coated_furnace(), recorded(GetParam(), 24), kFrames)[0].mean_value();
  EXPECT_NEAR(mean / expected, 1.0, 0.03);
}

/// Paths that end in a cell at the wall show its light to the metal.
TEST_P(RecordedPaths, HaveTheMeanWithoutACacheBeforeTheFirstCell) {
  constexpr int kFrames = 100;
  const auto radiance = [](CacheKind kind) {
    const RecordSums sums = record(furnace_with_metal(), recorded(kind, 24), kFrames)[0];
    return sums.radiance / sums.directions;
  };
  static const double expected = radiance(CacheKind::none);
  EXPECT_NEAR(radiance(GetParam()) / expected, 1.0, 0.03);
}

TEST_P(RecordedPaths, LeaveImagesAsTheyAre) {
  const auto run = [](bool records) {
    CachedFrameSettings settings = recorded(GetParam(), 45);
    settings.recorded = records;
    CachedFrames frames(find_builtin_scene("cornell-spheres")->build(), settings);
    std::vector<Rgb> all;
    for (int i = 0; i < 4; ++i) {
      const std::vector<Rgb>& frame = frames.render();
      all.insert(all.end(), frame.begin(), frame.end());
    }
    return all;
  };
  EXPECT_EQ(run(true), run(false));
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return testing::name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(AllCaches, RecordedPaths, ::testing::ValuesIn(testing::kCacheKinds), case_name);

TEST(RecordedPathGraphs, HaveLessNoise) {
  const auto variance = [](CacheKind kind) {
    const RecordSums sums = record(testing::closed_furnace(0.5f), recorded(kind, 24), 100)[0];
    const double mean = sums.values / sums.weights;
    return sums.squares / sums.weights - mean * mean;
  };
  EXPECT_LT(variance(CacheKind::apg), 0.3 * variance(CacheKind::none));
}

}  // namespace
}  // namespace relume
