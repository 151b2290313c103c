// States that camera subpaths record for Markov chains, and images with arbitrary states.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "techniques/guiding/markov_chain/testing/random_states.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/bdpt/testing/image_mean.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

constexpr uint32_t kVertices = 3;
constexpr uint32_t kNodes[1] = {0xffu};  // eight leaves over the cube from -1 to 1

template <typename ChainState>
bool is_stored(const MarkovRecord<ChainState>& record) {
  return record.cells[0].slot != kNoSlot;
}

/// A frame whose camera subpaths record samples, and states for both kinds of chains. Their tables are empty, so every
/// score above 0 starts a chain.
struct ChainFrame {
  ChainFrame(Scene scene, const BdptOptions& options)
      : frame(std::move(scene), options),
        samples(frame.hits.size() * kVertices),
        directions(samples.size()),
        lights(samples.size()),
        context{frame.context()} {
    const auto pixels = static_cast<uint32_t>(frame.hits.size());
    const MarkovGrid grid = FilledTable<LightState>().grid;
    context.chains.guide.guide.grid = context.chains.lights.chains.grid = grid;
    context.chains.guide.out = {mutable_view_of(directions), kVertices, pixels};
    context.chains.lights.out = {mutable_view_of(lights), kVertices, pixels};
    context.weighs_guide = false;
  }

  void record_samples() {
    PathRecording& recording = context.recording;
    recording.octree = recording.lookup.tree = {{kNodes, 1}, Vec3(-1), static_cast<float>(1u << kMaxOctreeDepth) / 2};
    recording.samples = mutable_view_of(samples);
    recording.vertices = kVertices;
    recording.pixels = static_cast<uint32_t>(frame.hits.size());
  }

  BdptFrame frame;
  std::vector<VertexSample> samples;
  std::vector<MarkovRecord<GuideState>> directions;
  std::vector<MarkovRecord<LightState>> lights;
  LearningContext context;
};

/// A sample has the incident radiance times cos θ / pdf_w. The score also has the BSDF.
TEST(BdptChains, ScoreDirectionsByTheLightOfSamples) {
  constexpr float kAlbedo = 0.6f;
  ChainFrame f(make_closed_sphere(kAlbedo), {.max_bounces = 6, .russian_roulette = false});
  f.record_samples();
  f.frame.run_in(f.context, 5, 0);
  const size_t pixels = f.frame.hits.size();
  size_t stored = 0;
  for (size_t i = 0; i < f.samples.size(); ++i) {
    const VertexSample& sample = f.samples[i];
    const GuideState& state = f.directions[i].state;
    ASSERT_EQ(is_stored(f.directions[i]), sample.value > 0.0f);
    if (!is_stored(f.directions[i])) continue;
    ++stored;
    ASSERT_NEAR(state.weight, sample.value * (kAlbedo / kPi), 1e-3f * state.weight);
    if (i < pixels || !is_stored(f.directions[i - pixels])) continue;
    // The target of the previous vertex is this one.
    const Vec3 onwards = mean_target(state) - mean_target(f.directions[i - pixels].state);
    ASSERT_GT(glm::dot(glm::normalize(onwards), direction_from_square(unpack_square(sample.direction))), 0.999f);
  }
  EXPECT_GT(stored, 2 * pixels);
}

TEST(BdptChains, LearnTheVisibleLightsOfConnections) {
  ChainFrame f(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false), {.max_bounces = 6});
  f.record_samples();
  f.frame.run_in(f.context, 5, 0);
  size_t visible = 0;
  for (size_t i = 0; i < f.samples.size(); ++i) {
    const uint32_t light = f.samples[i].light;
    const bool is_visible = light != kNoLight && (light & kVisibleLight) != 0;
    ASSERT_EQ(is_stored(f.lights[i]), is_visible);
    if (!is_visible) continue;
    ++visible;
    ASSERT_EQ(f.lights[i].state.light, light & ~kVisibleLight);
    ASSERT_GT(f.lights[i].state.weight, 0.0f);
  }
  EXPECT_GT(visible, 50u);
}

TEST(BdptChains, LearnWithoutSamplesAndWithRoulette) {
  ChainFrame both(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false), {.max_bounces = 6});
  both.record_samples();
  both.frame.run_in(both.context, 5, 0);
  ChainFrame alone(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false), {.max_bounces = 6});
  alone.frame.run_in(alone.context, 5, 0);
  EXPECT_EQ(alone.frame.radiance, both.frame.radiance);
  ChainFrame roulette(make_zoo(ZooLight::triangles, ZooCamera::pinhole, false),
                      {.max_bounces = 6, .connection_roulette = 1});
  roulette.frame.run_in(roulette.context, 5, 0);
  for (size_t i = 0; i < both.lights.size(); ++i) {
    ASSERT_EQ(is_stored(alone.directions[i]), is_stored(both.directions[i]));
    ASSERT_EQ(std::bit_cast<uint32_t>(alone.directions[i].state.weight),
              std::bit_cast<uint32_t>(both.directions[i].state.weight));
    for (const ChainFrame* f : {&alone, &roulette}) {  // it leaves connections to lights alone
      ASSERT_EQ(is_stored(f->lights[i]), is_stored(both.lights[i]));
      ASSERT_EQ(std::bit_cast<uint32_t>(f->lights[i].state.weight),
                std::bit_cast<uint32_t>(both.lights[i].state.weight));
    }
  }
}

TEST(BdptChains, UnallocatedPixelsLeaveNoStates) {
  ChainFrame f(make_closed_sphere(0.6f), {});
  for (size_t i = 0; i < f.lights.size(); ++i) {  // of an earlier frame
    f.directions[i].cells[0].slot = 1;
    f.lights[i].cells[1].slot = 1;
  }
  f.frame.allocation.assign(f.frame.hits.size(), 0);
  f.frame.allocation[37] = 1;
  f.frame.run_in(f.context, 1, 0);
  for (size_t i = 0; i < f.lights.size(); ++i) {
    const bool traced = i % f.frame.hits.size() == 37;
    EXPECT_TRUE(traced || !is_stored(f.directions[i])) << i;
    EXPECT_TRUE(traced || f.lights[i].cells[1].slot == kNoSlot) << i;
  }
  EXPECT_TRUE(is_stored(f.lights[37]));
}

/// A cache ends culled subpaths, so the light along their directions is not known.
TEST(BdptChains, CulledSubpathsLeaveNoStatesOfDirections) {
  for (const bool culled : {false, true}) {
    std::vector<MarkovRecord<GuideState>> directions(1);
    SubpathChains chains{};
    chains.guide.guide.grid = FilledTable<GuideState>().grid;
    chains.guide.out = {mutable_view_of(directions), 1, 1};
    const PathRecording recording{};
    SubpathRecorder recorder(recording, chains, 0);
    SurfacePoint sp = point_at({1, 0, 2}, Vec3(0, 1, 0));
    PathState path;
    recorder.arrived(sp, path);
    BsdfSample s;
    s.wi = Vec3(0, 1, 0);
    s.weight = Rgb(0.5f);
    s.pdf_w = 0.3f;
    path.throughput *= s.weight;
    path.ray.direction = s.wi;
    path.delta = false;
    ++path.bounce;
    recorder.scattered(BdptContext{}, sp, s, path);
    recorder.left(1.0f, s.pdf_w, 0.0f);
    recorder.moved(1.0f, 4.0f);
    recorder.weigh({});
    recorder.add(Rgb(1), {0, 0});
    if (culled) recorder.culled();
    recorder.finished(path);
    EXPECT_EQ(is_stored(directions[0]), !culled);
    if (!culled) {
      EXPECT_NEAR(directions[0].state.weight, 1, 1e-5f);
    }
  }
}

enum class Poison : int { narrow, garbage };

/// Fills the cells around each vertex with states before the subpath chooses a light and a direction there.
struct PoisoningPolicy : NoPolicy {
  FilledTable<GuideState>* directions = nullptr;
  FilledTable<LightState>* lights = nullptr;
  uint32_t light_count = 0;
  Poison poison = Poison::narrow;

  bool arrived(const SurfacePoint& sp, const PathState&) {
    directions->fill(sp, [&](uint32_t number) {
      return poison == Poison::garbage ? garbage_state(number) : narrow_state(sp.position + Vec3(0.5f, 0.7f, -0.2f));
    });
    lights->fill(sp, [&](uint32_t number) {
      Random random(number);
      const LightId light = random.next_bits() % (light_count + 1);  // the last does not exist
      const float weight = poison == Poison::garbage ? bits_float(random.next_bits()) : random.next();
      return LightState{light, weight, 1};
    });
    return true;
  }
};

/// Mean over images whose subpaths take lights and directions from poisoned chains.
ImageMean mean_with(Poison poison, const Scene& scene, const BdptOptions& options, uint32_t frames) {
  BdptFrame frame(Scene(scene), options);
  FilledTable<GuideState> directions;
  FilledTable<LightState> light_states;
  LearningContext c{frame.context()};
  const LightsView& lights = c.scene().lights;
  const LightTreeData tree = build_light_tree(lights);
  c.weighs_guide = false;
  c.path.selector.kind = LightSelectorKind::markov_chains;
  c.path.selector.tree = tree.view(lights);
  c.path.selector.chains = {light_states.grid, light_states.view(), 0.3f};
  c.path.directions.kind = DirectionSamplerKind::markov_chains;
  c.path.directions.chains = {.grid = directions.grid, .table = directions.view(), .bsdf_fraction = 0.3f};
  PoisoningPolicy policy;
  policy.directions = &directions;
  policy.lights = &light_states;
  policy.light_count = lights.lights.size;
  policy.poison = poison;
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  LightVertexArrays arrays;
  for (uint32_t i = 0; i < frames; ++i) {
    const SampleIndex index = frame.find_hits(2, i);
    glm::dvec3 light(0);
    for (uint32_t p = 0; p < frame.hits.size(); ++p) {
      const uint32_t x = p % frame.width();
      const uint32_t y = p / frame.width();
      BdptCounters counters;
      LightVertices kept = arrays.view();
      Sampler light_sampler = index.sampler(x, y);
      trace_light_subpath(c, light_sampler, kept, counters);
      Sampler sampler = index.sampler(x, y);
      ConnectionRoulette roulette;
      light += glm::dvec3(trace_camera_subpath(c, x, y, frame.hits[p], kept.view(), sampler, roulette, counters,
                                               OneLightSubpath{}, policy));
      try_camera_connections(c, kept, roulette, counters);
    }
    for (FixedPointRgb& splat : frame.splats) {
      light += glm::dvec3(splat.value());
      splat = {};
    }
    light /= static_cast<double>(frame.hits.size());
    sum += light;
    squares += light * light;
  }
  const double n = frames;
  return {sum / n, (squares / n - sum * sum / (n * n)) / n};
}

TEST(BdptChains, PoisonedTablesKeepTheMean) {
  constexpr uint32_t kFrames = 256;
  const Scene scene = find_builtin_scene("cornell")->build();
  const BdptOptions options{.max_bounces = 3};
  const ImageMean plain = mean_of(scene, options, kFrames);
  for (const Poison poison : {Poison::narrow, Poison::garbage}) {
    const ImageMean poisoned = mean_with(poison, scene, options, kFrames);
    const std::string name = poison == Poison::narrow ? "narrow" : "garbage";
    EXPECT_LT(std::sqrt(poisoned.variance.x), 0.05 * plain.value.x) << name << ": too noisy to say anything";
    expect_same_mean(poisoned, plain, name);
  }
}

}  // namespace
}  // namespace relume::testing
