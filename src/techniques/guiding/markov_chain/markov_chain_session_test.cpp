// Images with Markov chains: the mean of path tracing, whatever the tables hold, and less noise.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "techniques/guiding/markov_chain/testing/random_states.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "techniques/transport/path/walk.h"

namespace relume {
namespace {

using testing::Measured;

/// Fills the cells around each vertex with states before the path samples a direction there.
struct PoisoningPolicy : NoPolicy {
  testing::FilledTable<GuideState>* table = nullptr;
  bool garbage = false;

  bool arrived(const SurfacePoint& sp, const PathState&) {
    table->fill(sp, [&](uint32_t number) {
      return garbage ? testing::garbage_state(number) : testing::narrow_state(sp.position + Vec3(0.5f, 0.7f, -0.2f));
    });
    return true;
  }
};

enum class Poison : int { none, narrow, garbage };

/// Mean luminance of paths of single samples, and its standard error.
Measured mean_of_paths(const CompiledScene& scene, Poison poison, bool next_event, uint32_t samples) {
  constexpr uint32_t kSize = 24;
  testing::FilledTable<GuideState> table;
  PathContext c;
  c.scene = scene.view();
  c.selector.kind = LightSelectorKind::uniform;
  c.selector.uniform = make_uniform_lights(c.scene.lights);
  c.max_bounces = 3;
  c.next_event = next_event;
  if (poison != Poison::none) {
    c.directions.kind = DirectionSamplerKind::markov_chains;
    c.directions.chains = {.grid = table.grid, .table = table.view(), .bsdf_fraction = 0.3f};
  }
  double sum = 0;
  double squares = 0;
  for (uint32_t i = 0; i < kSize * kSize * samples; ++i) {
    const uint32_t x = i % kSize;
    const uint32_t y = i / kSize % kSize;
    Sampler sampler = Sampler::sequence(17, x, y, 0, i / (kSize * kSize));
    Sampler camera = sampler;
    const PathState start = start_path(c, x, y, camera);
    const Hit hit = intersect(c.scene, start.ray, camera.camera_ray_id());
    PoisoningPolicy policy;
    policy.table = &table;
    policy.garbage = poison == Poison::garbage;
    const PathState path = trace_path(c, x, y, sampler, hit, policy);
    const auto value = static_cast<double>(luminance(path.radiance));
    sum += value;
    squares += value * value;
  }
  const double n = double{kSize} * kSize * samples;
  const double mean = sum / n;
  return {mean, std::sqrt(std::max(squares / n - mean * mean, 0.0) / n)};
}

TEST(MarkovChainSession, PoisonedTablesKeepTheMeanOfPathTracing) {
  const CompiledScene scene(find_builtin_scene("cornell")->build(), {.camera = {}, .width = 24, .height = 24});
  const Measured expected = mean_of_paths(scene, Poison::none, true, 256);
  EXPECT_LT(expected.error, 0.02 * expected.mean);
  for (const Poison poison : {Poison::narrow, Poison::garbage}) {
    for (const bool next_event : {true, false}) {
      const Measured found = mean_of_paths(scene, poison, next_event, next_event ? 64 : 160);
      EXPECT_NEAR(found.mean, expected.mean, 5 * testing::error_of(found, expected))
          << static_cast<int>(poison) << ' ' << next_event;
      EXPECT_LT(found.error, 0.1 * expected.mean);
    }
  }
}

constexpr int kSize = 32;

/// A floor with a small lamp above it, beside a wall.
Scene lit_floor() {
  SceneBuilder builder("floor");
  const Index white = builder.add_material(matte("white", Rgb(0.6f)));
  builder.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), white);
  builder.add("wall", quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}), white);
  builder.add("lamp", quad({-0.2f, 2, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}),
              builder.add_material(emitter("lamp", Rgb(20))));
  builder.add_camera({0, 2.6f, 3.5f}, {0, 0.5f, 0}, 55);  // above the lamp, which emits downwards
  return builder.take();
}

RenderSettings settings_of(GuideChoice guide, LightSelectionChoice lights, bool nee) {
  RenderSettings s;
  s.width = s.height = kSize;
  s.threads = 1;
  s.path.max_bounces = 3;
  s.history = HistoryChoice::none;
  s.guide = guide;
  s.lights = lights;
  s.mcpg.nee = nee;
  return s;
}

/// Mean and mean square of the luminance of frames after the first ones, by seeds.
struct FrameMoments {
  Measured mean;
  Measured square;
};

FrameMoments frames_of(const Scene& scene, const RenderSettings& settings, int seeds, int first, int frames) {
  Session session(Scene(scene), settings);
  std::vector<double> means;
  std::vector<double> squares;
  for (int seed = 1; seed <= seeds; ++seed) {
    session.restart(seed);
    double sum = 0;
    double square = 0;
    for (int i = 0; i < first + frames; ++i) {
      session.render_frame();
      if (i < first) continue;
      const Image image = session.image();
      const double n = static_cast<double>(image.pixels.size()) * frames;
      for (const Rgb& p : image.pixels) {
        const auto y = static_cast<double>(luminance(p));
        sum += y / n;
        square += y * y / n;
      }
    }
    means.push_back(sum);
    squares.push_back(square);
  }
  return {testing::measured_over(means), testing::measured_over(squares)};
}

TEST(MarkovChainSession, LearnedTablesKeepTheMeanOfPathTracing) {
  const Scene scene = lit_floor();
  const Measured expected =
      frames_of(scene, settings_of(GuideChoice::bsdf, LightSelectionChoice::power, true), 10, 0, 32).mean;
  struct Case {
    GuideChoice guide;
    LightSelectionChoice lights;
    bool nee;
    EstimatorChoice estimator = EstimatorChoice::path;
  };
  for (const Case& c : {Case{GuideChoice::mcpg, LightSelectionChoice::power, true},
                        Case{GuideChoice::mcpg, LightSelectionChoice::power, false},
                        Case{GuideChoice::bsdf, LightSelectionChoice::mcls, true},
                        Case{GuideChoice::mcpg, LightSelectionChoice::mcls, true},
                        Case{GuideChoice::mcpg, LightSelectionChoice::vlc, true},
                        Case{GuideChoice::mcpg, LightSelectionChoice::neeat, false},
                        Case{GuideChoice::cdq, LightSelectionChoice::mcls, true},
                        Case{GuideChoice::mcpg, LightSelectionChoice::mcls, true, EstimatorChoice::bdpt},
                        Case{GuideChoice::mcpg, LightSelectionChoice::vlc, true, EstimatorChoice::bdpt},
                        Case{GuideChoice::cdq, LightSelectionChoice::mcls, true, EstimatorChoice::bdpt},
                        Case{GuideChoice::mcpg, LightSelectionChoice::mcls, true, EstimatorChoice::vcm}}) {
    RenderSettings settings = settings_of(c.guide, c.lights, c.nee);
    settings.estimator = c.estimator;
    const Measured found = frames_of(scene, settings, 10, 8, 24).mean;
    const double bias = c.estimator == EstimatorChoice::vcm ? 0.01 * expected.mean : 0;
    EXPECT_NEAR(found.mean, expected.mean, bias + 6 * testing::error_of(found, expected))
        << static_cast<int>(c.guide) << ' ' << static_cast<int>(c.lights) << ' ' << c.nee << ' '
        << static_cast<int>(c.estimator);
    EXPECT_LT(found.error, 0.1 * expected.mean);
  }
}

TEST(MarkovChainSession, LowersTheNoiseWithoutNextEventEstimation) {
  // Few directions of the BSDF meet the lamp. Guided ones find it almost always.
  RenderSettings guided = settings_of(GuideChoice::mcpg, LightSelectionChoice::power, false);
  guided.mcpg.bsdf_fraction = 0.15f;
  RenderSettings plain = guided;
  plain.mcpg.bsdf_fraction = 1;
  const Scene scene = lit_floor();
  const FrameMoments with = frames_of(scene, guided, 4, 24, 8);
  const FrameMoments without = frames_of(scene, plain, 4, 24, 8);
  EXPECT_LT(with.square.mean, 0.5 * without.square.mean);
}

TEST(MarkovChainSession, PointLightsRemainWithoutNextEventEstimation) {
  SceneBuilder builder("floor");
  builder.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), builder.add_material(matte("white", Rgb(0.6f))));
  builder.add_camera({0, 2, 0.01f}, {0, 0, 0}, 60);
  Scene scene = builder.take();
  PunctualLight light;
  light.intensity = Rgb(10);
  scene.lights.push_back(light);
  Node node;
  node.transform.translation = Vec3(0, 3, 0);
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  scene.add_node(node);
  const Measured expected =
      frames_of(scene, settings_of(GuideChoice::bsdf, LightSelectionChoice::power, true), 2, 0, 2).mean;
  const Measured found =
      frames_of(scene, settings_of(GuideChoice::mcpg, LightSelectionChoice::power, false), 2, 0, 2).mean;
  EXPECT_GT(expected.mean, 0.01);
  EXPECT_NEAR(found.mean, expected.mean, 2e-3 * expected.mean);
}

}  // namespace
}  // namespace relume
