// Tests the properties of hash grid caches: less error than path tracing, no light leaks, and fast response to changes.
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "relume/lab/metrics.h"
#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"
#include "techniques/gbuffer/primary_hits/primary_hits_pass.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"

namespace relume::support {
namespace {

Scene build(const char* name) { return find_builtin_scene(name)->build(); }

RenderSettings settings_of(CacheChoice cache, HistoryChoice history, int width, int height) {
  RenderSettings s = small_settings(width, height);
  s.cache = cache;
  s.history = history;
  return s;
}

/// A floor lit only on the left: an infinite black wall at x = 0 blocks the light. Seen from above at 64 pixels per
/// metre.
Scene divided_floor() {
  Scene scene;
  scene.name = "divided floor";
  add(scene, quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}), matte("floor", Rgb(0.8f)));
  add(scene, quad({0, 0, 4}, {0, 8, 0}, {0, 0, -8}), matte("wall", Rgb(0)));
  PunctualLight lamp;
  lamp.intensity = Rgb(4);
  add_light(scene, lamp, look_at({-0.5f, 1, 0}, {-0.5f, 0, 0.001f}));
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 1;
  add_camera(scene, camera, {0, 6, 0}, {0, -1, -1e-4f});
  return scene;
}

/// Mean radiance of columns [first, last) of `image`, counted from the middle to the right.
double mean_right(const Image& image, int first, int last) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = image.width / 2 + first; x < image.width / 2 + last; ++x)
      sum += static_cast<double>(luminance(image.at(x, y)));
  }
  return sum / (image.height * (last - first));
}

class Caches : public ::testing::TestWithParam<CacheChoice> {};

/// `reach`: of light behind the wall, in pixels.
void expect_light_near_wall(const RenderSettings& settings, int reach) {
  Session session(divided_floor(), settings);
  for (int frame = 0; frame < 6; ++frame) {
    session.render_frame();
    const Image image = session.image();
    const double lit = mean_right(image, -16, 0);
    EXPECT_GT(lit, 0.1);
    EXPECT_EQ(mean_right(image, reach, 64), 0.0) << frame;
    if (reach > 8) {
      EXPECT_LT(mean_right(image, 8, reach), 0.02 * lit) << frame;
    }
  }
}

TEST_P(Caches, LightStaysNearAWall) {
  // Cells of 8 pixels, 1/8 metre. Jitter moves both points by up to half a cell. A point nearer than half a cell to the
  // next one pools it if its own cell has few samples.
  const std::tuple<UndersampledCells, bool, int> list[] = {{UndersampledCells::keep, false, 8},
                                                           {UndersampledCells::keep, true, 16},
                                                           {UndersampledCells::neighbours, false, 12},
                                                           {UndersampledCells::neighbours, true, 20}};
  for (const auto& [undersampled_cells, jitter, reach] : list) {
    SCOPED_TRACE(reach);
    RenderSettings s = settings_of(GetParam(), HistoryChoice::none, 128, 128);
    s.psf.grid.cell_size = 8;
    s.psf.grid.undersampled_cells = undersampled_cells;
    s.psf.grid.jitter = jitter;
    expect_light_near_wall(s, reach);
  }
}

/// The same floor seen along the wall, `elevation` degrees above the floor. Cells are few pixels high and have few
/// samples, so that coarser ones replace them.
Scene grazed_floor(float elevation) {
  Scene scene = divided_floor();
  const float angle = glm::radians(elevation);
  scene.cameras.clear();
  for (Node& node : scene.nodes) node.camera = kNone;
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 0.25f;
  const Vec3 up_and_back(0, std::sin(angle), std::cos(angle));
  add_camera(scene, camera, 6.0f * up_and_back, -up_and_back);
  return scene;
}

TEST_P(Caches, LightReachesFurtherAtGrazingAnglesButFaintly) {
  // 128 pixels per metre; an edge of 10 pixels is rounded to 1/16 metre, 8 pixels.
  constexpr int kCell = 8;
  RenderSettings s = settings_of(GetParam(), HistoryChoice::none, 256, 64);
  s.psf.grid.cell_size = 10;
  s.psf.grid.undersampled_cells = UndersampledCells::coarser;
  Session session(grazed_floor(6), s);
  double lit = 0;
  double bands[4] = {};  // distance from the wall up to 2, 4 and 9 cells, and beyond
  const int ends[] = {kCell * 11 / 10, 2 * kCell, 4 * kCell, 9 * kCell, 128};
  constexpr int kFrames = 16;
  for (int frame = 0; frame < kFrames; ++frame) {
    session.render_frame();
    const Image image = session.image();
    lit += mean_right(image, -16, 0) / kFrames;
    for (int i = 0; i < 4; ++i) bands[i] += mean_right(image, ends[i], ends[i + 1]) / kFrames;
  }
  EXPECT_GT(lit, 0.05);
  EXPECT_LT(bands[0], 0.01 * lit);    // 0.0045
  EXPECT_LT(bands[1], 0.001 * lit);   // 0.0002
  EXPECT_LT(bands[2], 0.0002 * lit);  // 0
  // The coarsest replacement is eight cells wide, and both points are off by up to half a cell.
  EXPECT_EQ(bands[3], 0.0);
}

TEST_P(Caches, NeighboursLeakOneCellAtGrazingAngles) {
  constexpr int kCell = 8;  // as above
  RenderSettings s = settings_of(GetParam(), HistoryChoice::none, 256, 64);
  s.psf.grid.cell_size = 10;
  // Both points move by up to half a cell. A neighbour adds half a cell, and a coarser cell is two cells wide.
  for (const auto& [undersampled_cells, reach] :
       {std::pair(UndersampledCells::neighbours, 5 * kCell / 2), {UndersampledCells::neighbours_coarser, 3 * kCell}}) {
    SCOPED_TRACE(reach);
    s.psf.grid.undersampled_cells = undersampled_cells;
    Session session(grazed_floor(6), s);
    double lit = 0;
    double second = 0;
    double third = 0;
    constexpr int kFrames = 16;
    for (int frame = 0; frame < kFrames; ++frame) {
      session.render_frame();
      const Image image = session.image();
      lit += mean_right(image, -16, 0) / kFrames;
      second += mean_right(image, kCell, 2 * kCell) / kFrames;
      third += mean_right(image, 2 * kCell, 3 * kCell) / kFrames;
      EXPECT_EQ(mean_right(image, reach, 128), 0.0) << frame;
    }
    EXPECT_GT(lit, 0.05);
    EXPECT_LT(second, 0.01 * lit);
    EXPECT_LT(third, 0.0005 * lit);
  }
}

/// Mean squared error within `reach` pixels of the middle.
double error_at_wall(const Image& image, const Image& truth, int reach) {
  double sum = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = image.width / 2 - reach; x < image.width / 2 + reach; ++x)
      sum += static_cast<double>(length_squared(image.at(x, y) - truth.at(x, y)));
  }
  return sum / (2.0 * reach * image.height);
}

TEST(RefinedCells, BlurTheEdgeOfAShadowLess) {
  const auto rendered = [](CacheChoice cache, float refine) {
    RenderSettings s = settings_of(cache, HistoryChoice::none, 128, 128);
    s.psf.grid.cell_size = 16;
    s.psf.refine = refine;
    Session session(divided_floor(), s);
    for (int frame = 0; frame < 16; ++frame) session.render_frame();
    return session.image();
  };
  const Image truth = rendered(CacheChoice::none, 0);  // hardly any noise: one point light
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
    const double refined = error_at_wall(rendered(cache, 2), truth, 32);
    EXPECT_LT(refined, 0.8 * error_at_wall(rendered(cache, 0), truth, 32)) << static_cast<int>(cache);
  }
}

TEST(OtherCells, CanBeSwitchedInARunningSession) {
  Scene scene = build("cornell");
  for (Material& m : scene.materials) {
    m.specular = 1;
    m.roughness = 0.4f;
  }
  RenderSettings plain = settings_of(CacheChoice::apsf, HistoryChoice::none, 32, 32);
  plain.apsf.min_samples = 16;
  RenderSettings both = plain;
  both.psf.split = true;
  both.psf.refine = 2;
  const auto expect_like_new = [&](const RenderSettings& before, const RenderSettings& after) {
    Session running(scene, before);
    Session fresh(scene, after);
    for (int frame = 0; frame < 3; ++frame) running.render_frame();
    ASSERT_TRUE(running.set_settings(after));
    running.restart(7);
    fresh.restart(7);
    for (int frame = 0; frame < 3; ++frame) {
      running.render_frame();
      fresh.render_frame();
      EXPECT_TRUE(running.image().pixels == fresh.image().pixels) << frame;
    }
  };
  expect_like_new(plain, both);
  expect_like_new(both, plain);
}

TEST_P(Caches, LightDoesNotGoThroughAPanel) {
  // A panel without thickness, lit from behind and seen from the front; a mirror shows its back.
  Scene scene;
  scene.name = "panel";
  add(scene, quad({-0.4f, -0.4f, 0}, {0.8f, 0, 0}, {0, 0.8f, 0}), matte("panel", Rgb(0.8f)));
  PunctualLight lamp;
  lamp.intensity = Rgb(4);
  add_light(scene, lamp, look_at({0, 0, -1}, {0, 0.001f, 0}));
  add_camera(scene, Camera{}, {0, 0, 2}, {0, 0, -1});
  Material mirror = matte("mirror", Rgb(1));
  mirror.metallic = 1;
  mirror.roughness = 0;
  add(scene, quad({0.782f, -1.5f, -2.207f}, {0.91f, 0, 0.414f}, {0, 3, 0}), mirror);
  Session session(std::move(scene), settings_of(GetParam(), HistoryChoice::none, 64, 64));
  for (int frame = 0; frame < 4; ++frame) session.render_frame();
  const Image image = session.image();
  for (int y = 24; y < 40; ++y) {
    for (int x = 24; x < 40; ++x) EXPECT_EQ(image.at(x, y), Rgb(0));
  }
  Rgb brightest(0);
  for (int x = 48; x < 64; ++x) brightest = glm::max(brightest, image.at(x, 32));
  EXPECT_GT(brightest.g, 0.05f) << "the mirror shows the lit side";
}

/// Mean of `count` single frames.
Image mean_frame(Session& session, int count) {
  std::vector<Image> frames;
  for (int i = 0; i < count; ++i) {
    session.render_frame();
    frames.push_back(session.image());
  }
  return moments_of(std::move(frames)).mean_image();
}

/// Pixels that show the same surface point and no lamp, before and after a change of the scene.
std::vector<bool> steady_pixels(Session& before, Session& after) {
  std::vector<bool> steady;
  const Image a = mean_frame(before, 16);
  const Image b = mean_frame(after, 16);
  const View<const float> depth_a = buffer_table(before).read(kDepthAov);
  const View<const float> depth_b = buffer_table(after).read(kDepthAov);
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    const float d = depth_a[static_cast<uint32_t>(i)];
    steady.push_back(is_black(a.pixels[i]) && is_black(b.pixels[i]) &&
                     std::fabs(d - depth_b[static_cast<uint32_t>(i)]) < 0.01f * d);
  }
  return steady;
}

/// Progress of `image` between two images: 0 to 1.
double share_of_way(const Image& image, const Image& from, const Image& to, const std::vector<bool>& counts) {
  double gone = 0;
  double whole = 0;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    if (!counts[i]) continue;
    const glm::dvec3 way(to.pixels[i] - from.pixels[i]);
    gone += glm::dot(glm::dvec3(image.pixels[i] - from.pixels[i]), way);
    whole += glm::dot(way, way);
  }
  return gone / whole;
}

/// Mean luminance of `count` frames of a closed furnace.
double furnace_mean(const RenderSettings& settings, int count) {
  Session session(testing::closed_furnace(0.5f), settings);
  return mean_luminance(mean_frame(session, count));
}

TEST_P(Caches, FurnaceIsAnalyticWithAnyVariance) {
  RenderSettings s = settings_of(GetParam(), HistoryChoice::none, 48, 48);
  s.path.max_bounces = 5;
  s.apsf.min_samples = 16;
  const double expected = testing::closed_furnace_radiance(0.5, 5);
  // Cells of a path graph use one another, so that errors of the first frames persist: a run's mean varies by 0.35 %.
  // The energy dropped by algorithm 2 is twenty times larger.
  constexpr int kFrames = 32;
  constexpr double kTolerance = 0.018;
  for (const VarianceMeasure measure : {VarianceMeasure::relative, VarianceMeasure::absolute}) {
    s.apg.variance = s.apsf.variance = measure;
    for (const float constant : {0.0f, 0.001f, 0.05f, 1.0f, 100.0f, 1e12f}) {
      s.apg.variance_constant = constant;
      EXPECT_NEAR(furnace_mean(s, kFrames) / expected, 1.0, kTolerance) << "constant " << constant;
      if (GetParam() == CacheChoice::psf || GetParam() == CacheChoice::apsf) break;  // without a constant
    }
  }
  s.apg = {};
  s.apsf.survival_v0 = 0.02f;  // the variance of a sample is about 0.06 of its squared mean
  s.apsf.survival_v1 = 0.1f;
  for (const SurvivalFunction survival : {SurvivalFunction::linear, SurvivalFunction::smooth_linear}) {
    s.apsf.survival = survival;
    for (const BlendFunction blend : {BlendFunction::zero, BlendFunction::step, BlendFunction::one_over_square}) {
      s.apsf.blend = blend;
      EXPECT_NEAR(furnace_mean(s, kFrames) / expected, 1.0, kTolerance) << int(survival) << " " << int(blend);
      if (GetParam() == CacheChoice::psf || GetParam() == CacheChoice::apg) return;  // without survival and blending
    }
  }
}

class CachesAfterAMove : public Caches {};

TEST_P(CachesAfterAMove, MovedObjectsAppearWithinTenFrames) {
  constexpr int kSize = 80;
  for (const char* name : {"lamp", "tall box"}) {
    Scene scene = build("cornell");
    const Index node = node_named(scene, name);
    Transform moved = scene.nodes[static_cast<size_t>(node)].transform;
    moved.translation.x += name == std::string_view("lamp") ? 1.2f : 0.8f;
    RenderSettings s = settings_of(CacheChoice::none, HistoryChoice::accumulate, kSize, kSize);
    s.auxiliary = true;
    s.path.max_bounces = 0;
    Session emission(scene, s, {node});
    Session moved_emission(scene, s, {node});
    moved_emission.set_transform(node, moved);
    const std::vector<bool> counts = steady_pixels(emission, moved_emission);
    Session session(scene, settings_of(GetParam(), HistoryChoice::none, kSize, kSize), {node});
    mean_frame(session, 24);
    const Image before = mean_frame(session, 32);
    session.set_transform(node, moved);
    std::vector<Image> course;
    for (int i = 0; i < 12; ++i) course.push_back(mean_frame(session, 1));
    mean_frame(session, 20);
    const Image after = mean_frame(session, 32);
    std::string shares;
    for (const Image& frame : course)
      shares += std::to_string(share_of_way(frame, before, after, counts)).substr(0, 6) + " ";
    // A single frame of a path graph varies by 0.03; averages three.
    double share = 0;
    for (size_t i = 8; i < 11; ++i) share += share_of_way(course[i], before, after, counts) / 3;
    RecordProperty(name == std::string_view("lamp") ? "lamp" : "box", shares);  // stated on the page of the grid
    EXPECT_GT(share, 0.75) << name << ": " << shares;
  }
}

/// A lamp rotated against the pixel grid, in front of a dim wall.
Scene rotated_lamp() {
  Scene scene;
  scene.name = "edges";
  add(scene, quad({-4, -4, -0.5f}, {8, 0, 0}, {0, 8, 0}), matte("wall", Rgb(0.5f)));
  Material lamp = matte("lamp", Rgb(0));
  lamp.emission = Rgb(20);
  add(scene, quad({-0.5f, -0.3f, 0}, {0.9f, 0.2f, 0}, {-0.2f, 0.7f, 0}), lamp);
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(0.5f);
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = 1;
  add_camera(scene, camera, {0, 0, 2}, {0, 0, -1});
  return scene;
}

void expect_smooth_edges(CacheChoice cache, const Scene& scene, const Image& truth) {
  RenderSettings s = settings_of(cache, HistoryChoice::none, truth.width, truth.height);
  s.psf.edge_rays = 0;
  Session rough(scene, s);
  s.psf.edge_rays = 16;
  Session smooth(scene, s);
  // The path graph's first frame has no cells.
  mean_frame(rough, 2);
  mean_frame(smooth, 2);
  const double rough_error = mse(mean_frame(rough, 1), truth);
  EXPECT_LT(mse(mean_frame(smooth, 1), truth), 0.1 * rough_error);
  // Only noise: the mean of 64 frames is closer.
  EXPECT_LT(mse(mean_frame(smooth, 64), truth), 0.004 * rough_error);
}

std::string name_of(CacheChoice cache) {
  const char* names[] = {"none", "psf", "apsf", "apg", "apsf_apg"};
  return names[static_cast<int>(cache)];
}

/// All caches share the reference, which takes most of the time.
TEST(CachesAndLamps, EdgesAreSmooth) {
  const Scene scene = rotated_lamp();
  const Image truth = render(scene, settings_of(CacheChoice::none, HistoryChoice::accumulate, 48, 48), 2048);
  for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg}) {
    SCOPED_TRACE(name_of(cache));
    expect_smooth_edges(cache, scene, truth);
  }
}

std::string cache_name(const ::testing::TestParamInfo<CacheChoice>& instance) { return name_of(instance.param); }
constexpr CacheChoice kAll[] = {CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg, CacheChoice::apsf_apg};
INSTANTIATE_TEST_SUITE_P(All, Caches, ::testing::ValuesIn(kAll), cache_name);
constexpr CacheChoice kSimplestAndLargest[] = {CacheChoice::psf, CacheChoice::apsf_apg};
INSTANTIATE_TEST_SUITE_P(Some, CachesAfterAMove, ::testing::ValuesIn(kSimplestAndLargest), cache_name);
constexpr CacheChoice kOthers[] = {CacheChoice::apsf, CacheChoice::apg};
INSTANTIATE_TEST_SUITE_P(SlowOther, CachesAfterAMove, ::testing::ValuesIn(kOthers), cache_name);

}  // namespace
}  // namespace relume::support
