// Tests candidates whose choices learn, with learned structures of random content: means, records for learning, and
// that the choices are used.
#include "techniques/reuse/restir_pt/learned_choices.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "scene/compiled_scene.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/reuse/restir_pt/testing/random_choices.h"
#include "techniques/reuse/restir_pt/testing/traced_paths.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/path/recording_output.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

using testing::error_of;
using testing::Measured;
using testing::measured_over;
using testing::RandomChoices;
using testing::rule_of;
using testing::TracedPaths;

constexpr uint32_t kPixels = TracedPaths::kPixels;
constexpr uint32_t kBounces = 4;

/// The Cornell box without gloss: the records of wide lobes are bounded.
Scene matte_box() {
  Scene scene = find_builtin_scene("cornell")->build();
  for (Material& m : scene.materials) {
    m.roughness = 1;
    m.metallic = 0;
    m.specular = 0;
  }
  return scene;
}

double mean_light(const TracedPaths& traced) {
  double sum = 0;
  for (uint32_t p = 0; p < kPixels; ++p) sum += double{traced.light(p)} / kPixels;
  return sum;
}

struct Case {
  const char* name;
  const char* scene;
  ConnectRule rule;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

class LearnedCandidates : public ::testing::TestWithParam<Case> {};

/// Directions that shifts repeat lack those of the guide, and weights of picked lights are those of another selection.
TEST_P(LearnedCandidates, KeepTheMean) {
  constexpr uint32_t kSamples = 128;
  const Case& c = GetParam();
  const Scene scene = find_builtin_scene(c.scene)->build();
  std::vector<double> fixed;
  std::vector<double> learned;
  RandomChoices choices(kPixels);
  choices.learning.learns_lights = true;
  for (uint32_t sample = 0; sample < kSamples; ++sample) {
    fixed.push_back(mean_light({scene, c.rule, kBounces, sample}));
    learned.push_back(mean_light({scene, c.rule, kBounces, sample, choices.directions, choices.learning}));
  }
  const Measured expected = measured_over(fixed);
  const Measured found = measured_over(learned);
  EXPECT_LT(error_of(found, expected), 0.03 * expected.mean);
  EXPECT_NEAR(found.mean, expected.mean, 5 * error_of(found, expected));
  EXPECT_NE(found.mean, expected.mean);
}

using enum PathShiftKind;
INSTANTIATE_TEST_SUITE_P(
    Rules, LearnedCandidates,
    ::testing::Values(Case{"hybrid", "cornell", rule_of(hybrid)},
                      Case{"hybrid_2022", "cornell", rule_of(hybrid, ConnectRuleKind::distance_2022)},
                      Case{"reconnection", "cornell", rule_of(reconnection)},
                      Case{"replay", "cornell", rule_of(replay)},
                      // Half of all segments are not connectible: the guide must leave them to the BSDF.
                      Case{"short_segments", "cornell",
                           ConnectRule{.shift = hybrid, .kind = ConnectRuleKind::footprint, .least_footprint = 0.1f}}),
    case_name);

/// A chosen path begins in a direction of the guide in many pixels, unless shifts repeat all directions.
TEST(LearnedDirections, LeaveThePrimaryHit) {
  const Scene scene = find_builtin_scene("cornell")->build();
  for (const PathShiftKind shift : {hybrid, replay}) {
    const TracedPaths fixed(scene, rule_of(shift), kBounces, 3);
    RandomChoices choices(kPixels);
    const TracedPaths learned(scene, rule_of(shift), kBounces, 3, choices.directions, choices.learning);
    int indirect = 0;
    int different = 0;
    for (uint32_t p = 0; p < kPixels; ++p) {
      if (!fixed.has_path(p) || fixed.reservoirs[p].sample.length() < 2) continue;
      ++indirect;
      different += fixed.reservoirs[p].sample.first == learned.reservoirs[p].sample.first ? 0 : 1;
    }
    EXPECT_GT(indirect, 100);
    if (shift == replay) {
      EXPECT_EQ(different, 0);
    } else {
      EXPECT_GT(different, indirect / 4);
    }
  }
}

/// What the paths of one sample have recorded.
struct Records {
  std::vector<VertexSample> samples;
  std::vector<MarkovRecord<GuideState>> directions =
      std::vector<MarkovRecord<GuideState>>(size_t{RandomChoices::kVertices} * kPixels);
  std::vector<MarkovRecord<LightState>> lights =
      std::vector<MarkovRecord<LightState>>(size_t{RandomChoices::kVertices} * kPixels);

  /// `grid`: of empty tables, in which every chain is new.
  ChainOutput chain_output(const MarkovGrid& grid) {
    ChainOutput output;
    output.guide.guide.grid = output.lights.chains.grid = grid;
    output.guide.out = {mutable_view_of(directions), RandomChoices::kVertices, kPixels};
    output.lights.out = {mutable_view_of(lights), RandomChoices::kVertices, kPixels};
    return output;
  }
};

/// Records of candidates. `guided`: by random quadtrees.
Records of_candidates(const Scene& scene, uint32_t sample, bool guided) {
  const testing::FilledTable<GuideState> empty;
  Records records;
  RandomChoices choices(kPixels);
  choices.learning.chains = records.chain_output(empty.grid);
  const DirectionSampler directions = guided ? choices.directions : DirectionSampler{};
  const TracedPaths traced(scene, rule_of(hybrid), kBounces, sample, directions, choices.learning);
  records.samples = choices.samples;
  return records;
}

/// Records of path tracing without a guide.
Records of_paths(const Scene& scene, uint32_t sample) {
  constexpr uint32_t kEdge = TracedPaths::kEdge;
  const testing::FilledTable<GuideState> empty;
  Records records;
  RandomChoices choices(kPixels);
  const CompiledScene compiled(scene, {.camera = {}, .width = kEdge, .height = kEdge});
  std::vector<Rgb> radiance(kPixels);
  testing::trace_pixels(compiled, {.width = kEdge, .height = kEdge, .max_bounces = kBounces, .sample = sample},
                        RadianceOutput{mutable_view_of(radiance)}, RecordingOutput{choices.learning.samples},
                        records.chain_output(empty.grid));
  records.samples = choices.samples;
  return records;
}

bool similar(float a, float b) { return std::fabs(a - b) <= 1e-3f * std::max(std::fabs(a), std::fabs(b)); }

/// Without a guide and with the same lights, both trace the same paths.
TEST(LearnedRecords, AreThoseOfPathTracing) {
  const Scene scene = find_builtin_scene("cornell")->build();
  const Records candidates = of_candidates(scene, 3, false);
  const Records paths = of_paths(scene, 3);
  int with_value = 0;
  int with_light = 0;
  int states = 0;
  int different = 0;
  for (size_t i = 0; i < paths.samples.size(); ++i) {
    const VertexSample& a = candidates.samples[i];
    const VertexSample& b = paths.samples[i];
    with_value += b.value > 0.0f ? 1 : 0;
    with_light += b.light != kNoLight ? 1 : 0;
    const GuideState& guide = candidates.directions[i].state;
    const GuideState& expected = paths.directions[i].state;
    const LightState& light = candidates.lights[i].state;
    const LightState& expected_light = paths.lights[i].state;
    const bool records = paths.directions[i].cells[0].slot != kNoSlot;
    states += records ? 1 : 0;
    const bool same_guide = records == (candidates.directions[i].cells[0].slot != kNoSlot) &&
                            (!records || similar(guide.weight, expected.weight));
    const bool same_light = candidates.lights[i].cells[0].slot == paths.lights[i].cells[0].slot &&
                            (paths.lights[i].cells[0].slot == kNoSlot || similar(light.weight, expected_light.weight));
    const bool same_sample = a.region == b.region && a.light == b.light && a.direction == b.direction &&
                             a.densities == b.densities && similar(a.value, b.value);
    different += same_sample && same_guide && same_light ? 0 : 1;
  }
  EXPECT_GT(with_value, 200);
  EXPECT_GT(with_light, 300);
  EXPECT_GT(states, 200);
  // Rounding may end a path by Russian roulette, or move a ray across an edge.
  EXPECT_LE(different, static_cast<int>(paths.samples.size() / 100));
}

/// The light along a direction does not depend on what sampled it, although paths end where shifts cannot repeat it.
TEST(LearnedRecords, HaveTheMeanOfPathTracing) {
  constexpr uint32_t kSamples = 64;
  const Scene scene = matte_box();
  std::vector<double> found[RandomChoices::kVertices];
  std::vector<double> expected[RandomChoices::kVertices];
  const auto add = [&](const Records& records, std::vector<double>* means) {
    for (uint32_t v = 0; v < RandomChoices::kVertices; ++v) {
      double sum = 0;
      for (uint32_t p = 0; p < kPixels; ++p) sum += double{records.samples[v * kPixels + p].value} / kPixels;
      means[v].push_back(sum);
    }
  };
  for (uint32_t sample = 0; sample < kSamples; ++sample) {
    add(of_candidates(scene, sample, true), found);
    add(of_paths(scene, sample), expected);
  }
  const Measured first = measured_over(found[0]);
  const Measured truth = measured_over(expected[0]);
  EXPECT_LT(error_of(first, truth), 0.03 * truth.mean);
  EXPECT_NEAR(first.mean, truth.mean, 5 * error_of(first, truth));
}

/// Pixels without a path must not keep the records of an earlier frame.
TEST(LearnedRecords, AreEmptyWithoutAPath) {
  std::vector<VertexSample> samples(2);
  std::vector<MarkovRecord<GuideState>> directions(2);
  for (VertexSample& sample : samples) sample = {.region = 0, .value = 1};
  for (MarkovRecord<GuideState>& record : directions) record.cells[0].slot = 0;
  LearnedChoices choices;
  choices.samples.samples = mutable_view_of(samples);
  choices.samples.vertices = 2;
  choices.samples.pixels = 1;
  choices.records_samples = true;
  choices.chains.guide.out = {mutable_view_of(directions), 2, 1};
  choices.leave_out(0);
  for (size_t v = 0; v < 2; ++v) {
    EXPECT_EQ(samples[v].region, VertexSample{}.region);
    EXPECT_EQ(samples[v].value, 0.0f);
    EXPECT_EQ(directions[v].cells[0].slot, kNoSlot);
  }
}

}  // namespace
}  // namespace relume
