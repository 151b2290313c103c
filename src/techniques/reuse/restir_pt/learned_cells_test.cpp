// Candidates whose choices learn beside radiance caches: their light, and what the part behind their joints records.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/settings.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_pt/testing/expect_equal_means.h"
#include "techniques/reuse/restir_pt/testing/random_choices.h"
#include "techniques/reuse/restir_pt/testing/traced_paths.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"

namespace relume {
namespace {

using testing::Measured;
using testing::RandomChoices;
using testing::TracedPaths;

constexpr uint32_t kPixels = TracedPaths::kPixels;
constexpr uint32_t kVertices = kMaxRecordedVertices;
static_assert(kVertices <= kMostChainVertices);
constexpr uint32_t kBounces = 5;

/// The Cornell box in grey: with coloured surfaces, targets of cached ends differ from luminances of their light.
Scene grey_cornell(bool coated) {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.base_color = Rgb(0.6f);
    m.roughness = 1;
    m.metallic = 0;
    m.specular = 0;
    if (!coated) continue;
    m.clearcoat = 1;
    m.clearcoat_roughness = 0;
  }
  return scene;
}

/// Many segments are too short for a joint, so directions of the guide end paths.
constexpr ConnectRule kRule{
    .shift = PathShiftKind::hybrid, .kind = ConnectRuleKind::footprint, .least_footprint = 0.03f};

/// Candidates of one sample by random choices without Russian roulette, and their records.
template <typename Suffix>
struct Recorded {
  Recorded(const Scene& scene, const Suffix& suffix)
      : choices(kPixels * kVertices / RandomChoices::kVertices),
        directions(size_t{kVertices} * kPixels),
        lights(directions.size()),
        traced(scene, kRule, kBounces, 3, choices.directions, learning(), suffix, false) {}

  const LearnedChoices& learning() {
    LearnedChoices& l = choices.learning;
    l.learns_lights = true;
    l.samples.vertices = kVertices;
    l.samples.pixels = kPixels;
    const testing::FilledTable<GuideState> empty;
    l.chains.guide.guide.grid = l.chains.lights.chains.grid = empty.grid;
    l.chains.guide.out = {mutable_view_of(directions), kVertices, kPixels};
    l.chains.lights.out = {mutable_view_of(lights), kVertices, kPixels};
    return l;
  }

  RandomChoices choices;
  std::vector<MarkovRecord<GuideState>> directions;
  std::vector<MarkovRecord<LightState>> lights;
  TracedPaths traced;
};

/// Score of a chain's new state; 0 without one.
template <typename ChainState>
float score_of(const MarkovRecord<ChainState>& record) {
  return record.cells[0].slot == kNoSlot ? 0.0f : record.state.weight;
}

void expect_near(float found, float expected, size_t i) { EXPECT_NEAR(found, expected, 3e-3f * (1 + expected)) << i; }

/// Compares candidates of a cache without known cells with those of plain paths.
template <typename Suffix>
void expect_records_of_plain_paths(const Recorded<Suffix>& cached, const Recorded<PlainSuffix>& plain) {
  int ends = 0;
  int behind = 0;
  int states = 0;
  int weighted = 0;
  for (uint32_t p = 0; p < kPixels; ++p) {
    expect_near(cached.traced.light(p), plain.traced.light(p), p);
    ends += cached.traced.has_path(p) && cached.traced.reservoirs[p].sample.end() == PathEnd::cached ? 1 : 0;
  }
  for (size_t i = 0; i < size_t{kVertices} * kPixels; ++i) {
    const VertexSample& a = cached.choices.samples[i];
    const VertexSample& b = plain.choices.samples[i];
    EXPECT_EQ(a.region, b.region) << i;
    EXPECT_EQ(a.light, b.light) << i;
    EXPECT_EQ(a.direction, b.direction) << i;
    EXPECT_EQ(a.densities, b.densities) << i;
    expect_near(a.weight, b.weight, i);
    expect_near(a.value, b.value, i);
    expect_near(score_of(cached.directions[i]), score_of(plain.directions[i]), i);
    expect_near(score_of(cached.lights[i]), score_of(plain.lights[i]), i);
    weighted += std::fabs(b.weight - 1.0f) > 0.01f && b.value > 0.0f ? 1 : 0;
    if (i < size_t{2} * kPixels) continue;  // no joint is before the second vertex
    behind += b.value > 0.01f ? 1 : 0;
    states += score_of(plain.directions[i]) > 0.0f ? 1 : 0;
  }
  EXPECT_GT(ends, 10);
  EXPECT_GT(behind, 50);
  EXPECT_GT(states, 50);
  EXPECT_GT(weighted, 10) << "directions of the guide end no path";
}

/// The rest of the path has other units, here of a graph, whose samples have others again. Records are those in the
/// image.
TEST(LearnedRecordsWithCells, AreThoseOfPlainPathsWithoutKnownCells) {
  for (const bool coated : {false, true}) {
    const Scene scene = grey_cornell(coated);
    const Recorded<PlainSuffix> plain(scene, {});
    const CameraView& camera = plain.traced.shifter.context.scene.camera;
    HashGrid grid(PathSpaceFilterSettings{}.grid, 1 << 14);
    GraphSuffix graph;
    graph.graph.filter.grid = grid.view(camera);
    graph.graph.primary.enabled = false;
    expect_records_of_plain_paths(Recorded<GraphSuffix>(scene, graph), plain);
    SharcSuffix ends;
    ends.ends.cells.grid = grid.view(camera);
    expect_records_of_plain_paths(Recorded<SharcSuffix>(scene, ends), plain);
  }
}

struct Case {
  const char* name;
  CacheChoice cache;
  LightSelectionChoice lights;
  GuideChoice guide;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

constexpr int kMoving = 6;
constexpr int kKept = 8;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.octree = {.collapse = 32, .split = 64, .scale = false};  // small images have few samples
  settings.restir_pt.radius = 6;
  settings.restir_pt.cap = 8;
  settings.path.max_bounces = 3;
  settings.psf.edge_rays = 0;
  return settings;
}

RenderSettings settings_of(const Case& c) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.cache = c.cache;
  settings.lights = c.lights;
  settings.guide = c.guide;
  return settings;
}

class RestirPtLearnedCache : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(
    Choices, RestirPtLearnedCache,
    ::testing::Values(Case{"apg_vlc_cdq", CacheChoice::apg, LightSelectionChoice::vlc, GuideChoice::cdq},
                      Case{"apg_mcls_mcpg", CacheChoice::apg, LightSelectionChoice::mcls, GuideChoice::mcpg},
                      Case{"sharc_vlc_cdq", CacheChoice::sharc, LightSelectionChoice::vlc, GuideChoice::cdq},
                      Case{"sharc_neeat_mcpg", CacheChoice::sharc, LightSelectionChoice::neeat, GuideChoice::mcpg},
                      Case{"apsf_vlc_cdq", CacheChoice::apsf, LightSelectionChoice::vlc, GuideChoice::cdq}),
    case_name);

/// Without known cells, nothing is biased.
TEST_P(RestirPtLearnedCache, HasTheMeanOfPathTracingWithoutKnownCells) {
  const Scene scene = find_builtin_scene("cornell")->build();
  static const std::vector<Measured> truth =
      testing::after_moves(scene, settings_of(ReuseChoice::none), 8, kMoving, 64);
  RenderSettings settings = settings_of(GetParam());
  settings.psf.grid.min_count = settings.sharc.min_samples = 4096;
  testing::expect_equal(testing::after_moves(scene, settings, 24, kMoving, kKept), truth);
}

class RestirPtLearnedFurnace : public RestirPtLearnedCache {};
INSTANTIATE_TEST_SUITE_P(
    Choices, RestirPtLearnedFurnace,
    ::testing::Values(Case{"apg_vlc_cdq", CacheChoice::apg, LightSelectionChoice::vlc, GuideChoice::cdq},
                      Case{"apsf_apg_mcls_mcpg", CacheChoice::apsf_apg, LightSelectionChoice::mcls, GuideChoice::mcpg}),
    case_name);

/// Cells are known, and light of every bounce counts once.
TEST_P(RestirPtLearnedFurnace, HasTheMean) {
  constexpr float kAlbedo = 0.5f;
  constexpr int kFrames = 16;
  const RenderSettings settings = settings_of(GetParam());
  Session session(testing::closed_furnace(kAlbedo), settings);
  const Measured mean = testing::mean_over_seeds(16, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < kFrames; ++i) session.render_frame();
    return testing::means_of(session.image())[0];
  });
  const double expected = testing::closed_furnace_radiance(0.5, settings.path.max_bounces);
  EXPECT_LT(mean.error, 0.005 * expected);
  EXPECT_NEAR(mean.mean, expected, 0.01 * expected + 4.5 * mean.error);
}

}  // namespace
}  // namespace relume
