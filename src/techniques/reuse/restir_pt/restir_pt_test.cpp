#include <algorithm>
#include <array>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "frame/pipeline.h"
#include "render/build_pipeline.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_di/testing/lamps_over_plate.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_gi/testing/posts.h"
#include "techniques/reuse/restir_pt/stored_path.h"
#include "techniques/reuse/restir_pt/testing/expect_equal_means.h"
#include "techniques/reuse/restir_pt/testing/patch_beside_floors.h"

namespace relume {
namespace {

using testing::expect_equal;
using testing::FewerPaths;
using testing::Measured;

constexpr int kMoving = 6;
constexpr int kKept = 8;
constexpr int kBounces = 3;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.restir_pt.radius = 6;
  settings.path.max_bounces = kBounces;
  return settings;
}

/// The mean of many more samples than reuse has, so that its own noise is small.
std::vector<Measured> reference_of(const Scene& scene, int seeds = 8, int bounces = kBounces) {
  RenderSettings settings = settings_of(ReuseChoice::none);
  settings.path.max_bounces = bounces;
  return testing::after_moves(scene, settings, seeds, kMoving, 64);
}

Scene box_scene() { return find_builtin_scene("cornell")->build(); }

const std::vector<Measured>& box_reference() {
  static const std::vector<Measured> truth = reference_of(box_scene());
  return truth;
}

class RestirPtMode : public ::testing::TestWithParam<RestirPtSettings> {};

TEST_P(RestirPtMode, HasTheMeanOfPathTracingInImageAndBlocks) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.restir_pt = GetParam();
  settings.restir_pt.radius = 6;
  expect_equal(testing::after_moves(box_scene(), settings, 20, kMoving, kKept), box_reference());
}

std::string mode_name(const ::testing::TestParamInfo<RestirPtSettings>& info) {
  const RestirPtSettings& s = info.param;
  const std::array<const char*, 3> shifts{"reconnection", "replay", "hybrid"};
  return std::string(shifts[static_cast<size_t>(s.shift)]) + "_cap_" + std::to_string(s.cap) + "_neighbours_" +
         std::to_string(s.neighbours) + (s.feedback == ReuseFeedback::spatial ? "_spatial" : "_temporal") +
         (s.correction == PathCorrection::exact ? "" : "_lagging") +
         (s.connect == ConnectRuleKind::footprint ? "" : "_2022") + (s.reciprocal ? "_reciprocal" : "");
}

INSTANTIATE_TEST_SUITE_P(Unbiased, RestirPtMode,
                         ::testing::Values(RestirPtSettings{.cap = 0, .neighbours = 0}, RestirPtSettings{.cap = 0},
                                           RestirPtSettings{.neighbours = 0},
                                           RestirPtSettings{.feedback = ReuseFeedback::temporal, .cap = 8},
                                           RestirPtSettings{.cap = 8},
                                           RestirPtSettings{.correction = PathCorrection::lagging, .cap = 8},
                                           RestirPtSettings{.connect = ConnectRuleKind::distance_2022, .cap = 8},
                                           RestirPtSettings{.shift = PathShiftKind::reconnection, .cap = 8},
                                           RestirPtSettings{.shift = PathShiftKind::replay, .cap = 8},
                                           RestirPtSettings{.cap = 0, .reciprocal = true},
                                           RestirPtSettings{.cap = 8, .reciprocal = true}),
                         mode_name);

/// Pixels without a path pass their reservoirs to neighbours, by pairs or not, and to later frames.
class RestirPtFewerPaths : public ::testing::TestWithParam<std::tuple<FewerPaths, bool>> {};

TEST_P(RestirPtFewerPaths, HasTheMeanOfPathTracingInImageAndBlocks) {
  const auto [fewer, reciprocal] = GetParam();
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.restir_pt.cap = 8;
  settings.restir_pt.reciprocal = reciprocal;
  testing::apply(fewer, settings);
  expect_equal(testing::after_moves(box_scene(), settings, 48, kMoving, 24), box_reference(), 0.02,
               testing::bias_of(fewer));
}

INSTANTIATE_TEST_SUITE_P(Exact, RestirPtFewerPaths,
                         ::testing::Combine(::testing::Values(FewerPaths::upscaled, FewerPaths::adaptive,
                                                              FewerPaths::adaptive_after_pilot),
                                            ::testing::Bool()),
                         [](const auto& test) {
                           return testing::name_of(std::get<0>(test.param)) +
                                  (std::get<1>(test.param) ? "_reciprocal" : "");
                         });

TEST(RestirPtSparse, PixelsWithoutAPathKeepReservoirsWhileTheSceneRests) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.upscaling.factor = 2;
  Session session(testing::half_hidden_lamps(), settings);
  PunctualLight brighter;
  brighter.type = PunctualType::point;
  brighter.intensity = Rgb(2);
  testing::expect_reservoirs_to_be_kept<StoredPath>(session, "restir-pt", brighter);
}

struct SceneCase {
  const char* scene;
  PathShiftKind shift;
};

void PrintTo(const SceneCase& c, std::ostream* out) { *out << c.scene; }

std::string scene_name(const ::testing::TestParamInfo<SceneCase>& info) {
  const std::array<const char*, 3> shifts{"reconnection", "replay", "hybrid"};
  std::string name = std::string(info.param.scene) + "_" + shifts[static_cast<size_t>(info.param.shift)];
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// Reflections in a mirror, and light through a gap that few seeds find.
class SlowRestirPtScene : public ::testing::TestWithParam<SceneCase> {};

TEST_P(SlowRestirPtScene, HasTheMeanOfPathTracing) {
  const Scene scene = find_builtin_scene(GetParam().scene)->build();
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.restir_pt.shift = GetParam().shift;
  settings.restir_pt.cap = 4;
  settings.path.max_bounces = 6;
  expect_equal(testing::after_moves(scene, settings, 100, kMoving, kKept), reference_of(scene, 40, 6), 0.05);
}

INSTANTIATE_TEST_SUITE_P(SlowShifts, SlowRestirPtScene,
                         ::testing::Values(SceneCase{"cornell", PathShiftKind::reconnection},
                                           SceneCase{"cornell", PathShiftKind::replay},
                                           SceneCase{"cornell", PathShiftKind::hybrid},
                                           SceneCase{"cornell-mirror", PathShiftKind::reconnection},
                                           SceneCase{"cornell-mirror", PathShiftKind::replay},
                                           SceneCase{"cornell-mirror", PathShiftKind::hybrid},
                                           SceneCase{"door", PathShiftKind::reconnection},
                                           SceneCase{"door", PathShiftKind::replay},
                                           SceneCase{"door", PathShiftKind::hybrid}),
                         scene_name);

class SlowRestirPtCaustics : public ::testing::TestWithParam<SceneCase> {};

/// Few paths find most of the light of caustics. Reuse begins with the paths of path tracing at the same seed, so that
/// the difference of both images has far less noise than each of them. Blocks with caustics have no reliable errors.
TEST_P(SlowRestirPtCaustics, HaveTheMeanOfPathTracing) {
  constexpr int kSeeds = 200;
  const Scene scene = find_builtin_scene(GetParam().scene)->build();
  const auto values = [&](ReuseChoice reuse) {
    RenderSettings settings = settings_of(reuse);
    settings.restir_pt.shift = GetParam().shift;
    settings.restir_pt.cap = 4;
    settings.path.max_bounces = 6;
    return testing::values_after_moves(scene, settings, kSeeds, kMoving, kKept)[0];
  };
  const std::vector<double> truth = values(ReuseChoice::none);
  std::vector<double> differences = values(ReuseChoice::restir_pt);
  for (size_t i = 0; i < truth.size(); ++i) differences[i] -= truth[i];
  const Measured difference = testing::measured_over(differences);
  EXPECT_LT(difference.error, 0.015 * testing::measured_over(truth).mean);
  EXPECT_NEAR(difference.mean, 0, 5 * difference.error + 1e-6);
}

INSTANTIATE_TEST_SUITE_P(SlowShifts, SlowRestirPtCaustics,
                         ::testing::Values(SceneCase{"cornell-glass", PathShiftKind::reconnection},
                                           SceneCase{"cornell-glass", PathShiftKind::replay},
                                           SceneCase{"cornell-glass", PathShiftKind::hybrid}),
                         scene_name);

/// Expects the mean of path tracing with hybrid shifts and a short history.
void expect_mean_of_paths(const Scene& scene, bool reciprocal = false) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.restir_pt.cap = 8;
  settings.restir_pt.reciprocal = reciprocal;
  expect_equal(testing::after_moves(scene, settings, 20, kMoving, kKept), reference_of(scene));
}

TEST(RestirPtMirror, HasTheMeanOfPathTracing) { expect_mean_of_paths(find_builtin_scene("cornell-mirror")->build()); }

/// Posts hide parts of the ceiling from the floor.
TEST(RestirPtPosts, HasTheMeanOfPathTracing) { expect_mean_of_paths(testing::posts()); }

/// Both pixels of a pair must refuse each other at the same edges.
TEST(RestirPtReciprocal, HasTheMeanOfPathTracingBetweenPosts) { expect_mean_of_paths(testing::posts(), true); }

/// Sheets with stochastic alpha are occluders and vertices.
TEST(RestirPtAlpha, HasTheMeanOfPathTracing) {
  Scene scene = testing::posts();
  Material veil = testing::matte(Rgb(0.3f, 0.6f, 0.4f));
  veil.alpha_mode = AlphaMode::blend;
  veil.alpha = 0.4f;
  testing::add_mesh(scene, veil, quad({-3, 1.5f, -3}, {6, 0, 0}, {0, 0, 6}));
  expect_mean_of_paths(scene);
}

/// A medium around everything.
TEST(RestirPtMedium, HasTheMeanOfPathTracing) {
  Scene scene = find_builtin_scene("cornell")->build();
  testing::add_mesh(scene, testing::tint({0.05f, 0.1f, 0.2f}), box(Vec3(-40), Vec3(40)));
  expect_mean_of_paths(scene);
}

/// Paths have wavelengths, which shifts keep.
TEST(RestirPtDispersion, HasTheMeanOfPathTracing) {
  Scene scene = find_builtin_scene("cornell-spheres")->build();
  int glass = 0;
  for (Material& material : scene.materials) {
    if (!(material.transmission > 0)) continue;
    material.dispersion = 2;
    material.roughness = 0.4f;  // vertices on the glass can be joints
    ++glass;
  }
  ASSERT_GT(glass, 0);
  expect_mean_of_paths(scene);
}

TEST(RestirPtIndirectRate, KeepsTheMean) {
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  settings.restir_pt.cap = 8;
  settings.path.indirect_rate = 0.5f;
  expect_equal(testing::after_moves(scene, settings, 24, kMoving, kKept), reference_of(scene), 0.03);
}

/// Variance between seeds of a frame's pixels, in the left and in the right half of the image.
std::array<double, 2> noise_of(const Scene& scene, const RenderSettings& settings) {
  constexpr size_t kSize = testing::kReuseSize;
  constexpr int kRuns = 64;
  Session session(Scene(scene), settings);
  std::vector<double> sum(kSize * kSize);
  std::vector<double> squares(kSize * kSize);
  for (int seed = 1; seed <= kRuns; ++seed) {
    session.restart(seed);
    session.render_frame();
    const Image image = session.image();
    for (size_t p = 0; p < kSize * kSize; ++p) {
      const auto y = static_cast<double>(luminance(image.pixels[p]));
      sum[p] += y / kRuns;
      squares[p] += y * y / kRuns;
    }
  }
  std::array<double, 2> variance{};
  for (size_t p = 0; p < kSize * kSize; ++p) variance[p % kSize * 2 / kSize] += squares[p] - sum[p] * sum[p];
  return variance;
}

/// Replayed paths miss the patch. On the mirror, nothing can be reconnected at the second vertex. Hybrid shifts repeat
/// the reflection in the mirror, and then connect to the patch.
TEST(RestirPtNoise, IsLeastWithHybridShifts) {
  const Scene scene = testing::patch_beside_floors();
  const auto noise = [&](PathShiftKind shift) {
    RenderSettings settings = settings_of(ReuseChoice::restir_pt);
    settings.history = HistoryChoice::none;
    settings.restir_pt.shift = shift;
    settings.restir_pt.neighbours = 6;
    return noise_of(scene, settings);
  };
  const std::array<double, 2> reconnection = noise(PathShiftKind::reconnection);
  const std::array<double, 2> replay = noise(PathShiftKind::replay);
  const std::array<double, 2> hybrid = noise(PathShiftKind::hybrid);
  EXPECT_GT(hybrid[0], 0);
  EXPECT_LT(hybrid[0], 0.7 * replay[0]) << "matte";
  EXPECT_LT(hybrid[1], 0.7 * replay[1]) << "mirror";
  EXPECT_LT(hybrid[1], 0.7 * reconnection[1]) << "mirror";
}

TEST(RestirPtFrames, AreNotIndependent) {
  RenderSettings settings = settings_of(ReuseChoice::restir_pt);
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 41u);
  EXPECT_FALSE(build_passes(settings, host_memory()).pipeline.keeps_to_pixels());
  settings.restir_pt.cap = 0;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 1u);
}

/// Without scattering there is nothing to reuse.
TEST(RestirPtBounces, AreOneAtLeast) {
  const auto rendered = [&](ReuseChoice reuse) {
    RenderSettings settings = settings_of(reuse);
    settings.path.max_bounces = 0;
    Session session(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    return session.image();
  };
  EXPECT_EQ(rendered(ReuseChoice::restir_pt).pixels, rendered(ReuseChoice::none).pixels);
}

}  // namespace
}  // namespace relume
