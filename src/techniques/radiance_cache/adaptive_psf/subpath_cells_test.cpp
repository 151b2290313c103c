// Caches with bidirectional estimators: the same energy as without, sharp splats, and less noise.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_space_filter/path_space_filter.h"
#include "techniques/spatial/hash_grid/hash_grid_table.h"
#include "techniques/spatial/hash_grid/testing/grid_camera.h"

namespace relume {
namespace {

RenderSettings settings_of(EstimatorChoice estimator, CacheChoice cache, int size = 24) {
  RenderSettings settings;
  settings.width = settings.height = size;
  settings.threads = 1;
  settings.estimator = estimator;
  settings.cache = cache;
  settings.history = HistoryChoice::none;  // each frame is an image
  settings.apsf.min_samples = 16;
  return settings;
}

std::string name_of(const RenderSettings& settings) {
  std::string name = settings.estimator == EstimatorChoice::vcm ? "vcm" : "bdpt";
  return name + (settings.cache == CacheChoice::apsf ? " apsf" : " psf");
}

/// Mean over images, and its standard error.
struct ImagesMean {
  glm::dvec3 value{0};
  glm::dvec3 error{0};
};

/// Of the frames in the second half of `seeds` independent runs of `frames` frames: earlier ones fill the cells.
ImagesMean mean_of_runs(const Scene& scene, const RenderSettings& settings, int seeds, int frames) {
  Session session(Scene(scene), settings);
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  for (int seed = 1; seed <= seeds; ++seed) {
    session.restart(seed);
    glm::dvec3 mean(0);
    for (int i = 0; i < frames; ++i) {
      session.render_frame();
      if (i < frames / 2) continue;
      const Image image = session.image();
      const double share = 1.0 / (static_cast<double>(image.pixels.size()) * (frames - frames / 2));
      for (const Rgb& p : image.pixels) mean += glm::dvec3(p) * share;
    }
    sum += mean;
    squares += mean * mean;
  }
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  const double n = seeds;
  const glm::dvec3 variance = glm::max(squares / n - sum * sum / (n * n), glm::dvec3(0));
  return {sum / n, glm::sqrt(variance / (n - 1))};
}

void expect_close(const ImagesMean& a, const ImagesMean& b, double bias, const std::string& name) {
  constexpr double kStandardErrors = 5;
  for (int c = 0; c < 3; ++c) {
    const double noise = std::hypot(a.error[c], b.error[c]);
    EXPECT_LT(noise, 0.02 * b.value[c]) << name << ": too noisy to say anything";
    EXPECT_NEAR(a.value[c], b.value[c], kStandardErrors * noise + bias * b.value[c]) << name << ", channel " << c;
  }
}

/// L = Σ ρ^k, k = 0 … D: the parts in cells and in splats add up.
TEST(SubpathCells, KeepTheEnergyOfAFurnace) {
  constexpr float kAlbedo = 0.6f;
  constexpr int kBounces = 4;
  const double expected = testing::closed_furnace_radiance(static_cast<double>(kAlbedo), kBounces);
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
      RenderSettings settings = settings_of(estimator, cache);
      settings.path.max_bounces = kBounces;
      const ImagesMean mean = mean_of_runs(testing::closed_furnace(kAlbedo), settings, 4, 32);
      EXPECT_NEAR(mean.value.g / expected, 1.0, 0.02) << name_of(settings);
    }
  }
}

using Pairs = std::vector<std::pair<EstimatorChoice, CacheChoice>>;

void expect_path_tracing(const Pairs& pairs) {
  const Scene scene = find_builtin_scene("cornell-mirror")->build();
  const ImagesMean path = mean_of_runs(scene, settings_of(EstimatorChoice::path, CacheChoice::none), 12, 64);
  for (const auto& [estimator, cache] : pairs) {
    const RenderSettings settings = settings_of(estimator, cache);
    const double bias = estimator == EstimatorChoice::vcm ? 0.03 : 0.02;
    expect_close(mean_of_runs(scene, settings, 8, 32), path, bias, name_of(settings));
  }
}
/// Each estimator and each cache. The test of the furnace has all four pairs.
TEST(SubpathCells, AgreeWithPathTracing) {
  expect_path_tracing({{EstimatorChoice::bdpt, CacheChoice::psf}, {EstimatorChoice::vcm, CacheChoice::apsf}});
}
TEST(SlowSubpathCells, AgreeWithPathTracing) {
  expect_path_tracing({{EstimatorChoice::bdpt, CacheChoice::apsf}, {EstimatorChoice::vcm, CacheChoice::psf}});
}

/// Means of bidirectional path tracing, rendered once per process.
const ImagesMean& mean_of_spheres() {
  static const ImagesMean mean = mean_of_runs(find_builtin_scene("cornell-spheres")->build(),
                                              settings_of(EstimatorChoice::bdpt, CacheChoice::none), 8, 32);
  return mean;
}

TEST(SubpathCells, AgreeWithSplitAndFinerCells) {
  const Scene scene = find_builtin_scene("cornell-spheres")->build();
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    RenderSettings settings = settings_of(estimator, CacheChoice::psf);
    settings.psf.split = true;
    settings.psf.refine = 2;
    if (estimator == EstimatorChoice::vcm) settings.vcm.radius = 0.01f;  // some light comes from merging
    const double bias = estimator == EstimatorChoice::vcm ? 0.03 : 0.02;
    expect_close(mean_of_runs(scene, settings, 8, 32), mean_of_spheres(), bias, name_of(settings));
  }
}

TEST(SubpathCells, AgreeWithLearnedLightsAndDirections) {
  const Scene scene = find_builtin_scene("cornell-spheres")->build();
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    RenderSettings settings = settings_of(estimator, CacheChoice::apsf);
    settings.lights = LightSelectionChoice::vlc;
    settings.guide = GuideChoice::cdq;
    settings.octree = {.collapse = 32, .split = 64, .scale = false};  // many regions
    const double bias = estimator == EstimatorChoice::vcm ? 0.03 : 0.02;
    expect_close(mean_of_runs(scene, settings, 8, 32), mean_of_spheres(), bias, name_of(settings));
  }
}

TEST(SubpathCells, AgreeWithAdaptiveSampling) {
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings settings = settings_of(EstimatorChoice::bdpt, CacheChoice::none);
  const ImagesMean uniform = mean_of_runs(scene, settings, 8, 32);
  settings.history = HistoryChoice::accumulate;
  settings.allocation = AllocationChoice::adaptive;
  settings.cache = CacheChoice::psf;
  expect_close(mean_of_runs(scene, settings, 8, 32), uniform, 0.03, "adaptive");
}

/// A floor below a slab of glass under a spotlight. With three bounces, only splats find the light that the slab
/// refracts to the floor.
Scene floor_below_glass() {
  SceneBuilder b("slab");
  b.add("slab", box({-1, 1, -1}, {1, 1.1f, 1}), b.add_material(glass("slab", 1.5f)));
  b.add("floor", quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}), b.add_material(matte("floor", Rgb(0.8f))));
  b.add_camera({0, 0.5f, 0.9f}, {0, 0, 0}, 20);
  Scene scene = b.take();
  scene.lights.push_back({"spot", PunctualType::spot, Rgb(50), 0.1f, 0.12f});
  Node node;
  node.transform = look_at({0.05f, 2, 0}, {0, 0, 0});
  node.light = 0;
  scene.add_node(std::move(node));
  return scene;
}

/// Filtered light would reach pixels beside the cone of the spotlight.
TEST(SubpathCells, LeaveSplatsSharp) {
  const auto lit_pixels = [](CacheChoice cache) {
    RenderSettings settings = settings_of(EstimatorChoice::bdpt, cache);
    settings.path.max_bounces = 3;
    settings.history = HistoryChoice::accumulate;
    Session session(floor_below_glass(), settings);
    for (int i = 0; i < 64; ++i) session.render_frame();
    const std::vector<Rgb> pixels = session.image().pixels;
    return std::count_if(pixels.begin(), pixels.end(), [](const Rgb& p) { return p.g > 0; });
  };
  const auto without = lit_pixels(CacheChoice::none);
  EXPECT_GT(without, 20);
  EXPECT_NEAR(static_cast<double>(lit_pixels(CacheChoice::psf)), static_cast<double>(without),
              0.1 * static_cast<double>(without));
}

/// Median over the pixels of the squared error of luminance in the last of several frames.
double median_error(const Scene& scene, const RenderSettings& settings, const std::vector<Rgb>& truth) {
  Session session(Scene(scene), settings);
  for (int i = 0; i < 16; ++i) session.render_frame();
  const std::vector<Rgb> pixels = session.image().pixels;
  std::vector<double> errors;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double error = static_cast<double>(luminance(pixels[i]) - luminance(truth[i]));
    errors.push_back(error * error);
  }
  std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
  return errors[errors.size() / 2];
}

TEST(SubpathCells, LowerTheNoiseOfAFrame) {
  constexpr int kSize = 48;
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings long_settings = settings_of(EstimatorChoice::bdpt, CacheChoice::none, kSize);
  long_settings.history = HistoryChoice::accumulate;
  long_settings.seed = 7;
  Session reference(Scene(scene), long_settings);
  // Adds a ninety-sixth of a frame's error to both sides, where the bound below leaves a third of it.
  for (int i = 0; i < 96; ++i) reference.render_frame();
  const std::vector<Rgb> truth = reference.image().pixels;
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    const double noisy = median_error(scene, settings_of(estimator, CacheChoice::none, kSize), truth);
    const RenderSettings settings = settings_of(estimator, CacheChoice::psf, kSize);
    EXPECT_LT(median_error(scene, settings, truth), 0.3 * noisy) << name_of(settings);
  }
}

double statistic(const Session& session, std::string_view name) {
  for (const PassStatistic& s : session.statistics().pass_statistics) {
    if (s.name.ends_with(name)) return s.value;
  }
  ADD_FAILURE() << "no statistic " << name;
  return 0;
}

TEST(SubpathCells, SurvivalSavesRays) {
  const Scene scene = find_builtin_scene("cornell")->build();
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    Session full(Scene(scene), settings_of(estimator, CacheChoice::psf, 48));
    Session adaptive(Scene(scene), settings_of(estimator, CacheChoice::apsf, 48));
    for (int i = 0; i < 8; ++i) {
      full.render_frame();
      adaptive.render_frame();
    }
    EXPECT_EQ(statistic(full, "culled"), 0.0);
    EXPECT_GT(statistic(adaptive, "culled"), 0.05);
    EXPECT_LT(adaptive.statistics().rays, full.statistics().rays);
  }
}

SurfacePoint matte_point() {
  SurfacePoint sp{};
  sp.position = Vec3(0.1f, 0.2f, -1);
  sp.ng = sp.ns = sp.wo = sp.wo_local = Vec3(0, 0, 1);
  sp.frame = make_frame(sp.ng);
  sp.bsdf.lobe_count = 1;
  sp.bsdf.lobes[0].kind = LobeKind::lambert;
  sp.bsdf.lobes[0].color = Rgb(0.5f);
  sp.bsdf.lobes[0].weight = 1;
  return sp;
}

/// A vertex behind a mirror lacks no light of splats or reservoirs, so it does not share the cell of the same point in
/// direct view.
TEST(SubpathCells, VerticesBehindOthersHaveCellsOfTheirOwn) {
  HashGrid grid(HashGridSettings{}, 64);
  FilterContext context;
  context.grid = grid.view(grid_camera());
  const auto layer = [&](bool by_prefix, bool direct_apart, uint32_t bounce) {
    context.by_prefix = by_prefix;
    context.direct_apart = direct_apart;
    SurfacePoint sp = matte_point();
    PathState path;
    path.bounce = bounce;
    const SampleIndex index;
    FilterVertex vertex(context, index, 0, 0);
    NoPolicy none;
    vertex.arrived(sp, path, none);
    EXPECT_TRUE(vertex.reached());
    return vertex.pixel().point.layer;
  };
  EXPECT_EQ(layer(false, false, 0), 0);
  EXPECT_EQ(layer(false, false, 1), 0);
  EXPECT_EQ(layer(true, false, 0), 0);
  EXPECT_EQ(layer(true, false, 1), kBehindLayer);
  EXPECT_EQ(layer(false, true, 0), 0);
  EXPECT_EQ(layer(false, true, 1), kBehindLayer);
}

/// Behind a wide lobe of a surface that is not filtered itself, weights depend on the point of that surface.
TEST(SubpathCells, NoVertexBehindAWideLobeIsFiltered) {
  HashGrid grid(HashGridSettings{}, 64);
  FilterContext context;
  context.grid = grid.view(grid_camera());
  const auto is_filtered_behind = [&](bool by_prefix, float alpha, bool delta) {
    context.by_prefix = by_prefix;
    context.direct_apart = !by_prefix;  // does not decide it
    SurfacePoint sp = matte_point();
    PathState path;
    path.bounce = 1;
    path.delta = delta;
    BsdfSample sample;
    sample.alpha = alpha;
    const SampleIndex index;
    FilterVertex vertex(context, index, 0, 0);
    NoPolicy none;
    vertex.scattered(sp, sample, path, none);
    vertex.arrived(sp, path, none);
    return vertex.reached();
  };
  EXPECT_FALSE(is_filtered_behind(true, 1.0f, false));
  EXPECT_TRUE(is_filtered_behind(true, 0.01f, false));
  EXPECT_TRUE(is_filtered_behind(true, 0.0f, true));
  EXPECT_TRUE(is_filtered_behind(false, 1.0f, false));
}

TEST(SubpathCells, RefuseWhatHasNoSampleForACell) {
  RenderSettings settings;
  for (const CacheChoice cache :
       {CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg, CacheChoice::sharc}) {
    settings.cache = cache;
    const bool of_every_vertex = cache != CacheChoice::psf && cache != CacheChoice::apsf;
    for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
      settings.estimator = estimator;
      EXPECT_EQ(refusal(settings).empty(), !of_every_vertex);
    }
    settings.estimator = EstimatorChoice::light;
    EXPECT_THROW(plan(settings), Error);
  }
}

}  // namespace
}  // namespace relume
