// Reservoirs for direct light with the estimators "bdpt", "light" and "vcm": means against path tracing.
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "scene/testing/media.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

using testing::error_of;
using testing::Measured;

constexpr int kSize = 20;
constexpr int kFrames = 16;
constexpr int kSlowFrames = 96;
constexpr int kSeeds = 12;
/// Largest standard errors, relative.
constexpr double kMostError = 0.03;
constexpr double kMostSlowError = 0.015;
constexpr double kBiasOfVcm = 0.01;  ///< blur over the merging radius
constexpr double kRounding = 1e-4;

/// A floor and a wall under a large dim lamp and a small bright one.
Scene two_lamps(const std::string& name, const Material& floor) {
  SceneBuilder b(name);
  b.add("floor", quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}), b.add_material(floor));
  b.add("wall", quad({-2, 0, -2}, {4, 0, 0}, {0, 4, 0}), b.add_material(matte("wall", Rgb(0.7f))));
  b.add("large", quad({-1, 3.9f, -1}, {2, 0, 0}, {0, 0, 2}), b.add_material(emitter("large", Rgb(2))));
  b.add("small", quad({1, 1.5f, -0.5f}, {0.1f, 0, 0}, {0, 0, 0.1f}), b.add_material(emitter("small", Rgb(200))));
  b.add_camera({0, 2, 6}, {0, 1.2f, 0}, 40);
  return b.take();
}
Scene matte_room() { return two_lamps("matte room", matte("floor", Rgb(0.7f))); }
Scene glossy_room() { return two_lamps("glossy room", metal("floor", Rgb(0.8f), 0.4f)); }

RenderSettings settings_of(EstimatorChoice estimator, ReuseChoice reuse) {
  RenderSettings settings;
  settings.width = settings.height = kSize;
  settings.threads = 1;
  settings.estimator = estimator;
  settings.reuse = reuse;
  settings.restir.radius = 6;
  settings.restir.cap = 8;
  settings.bdpt.connection_roulette = 0;  // light subpaths are traced with one bounce, too
  settings.path.max_bounces = 2;
  return settings;
}

/// Mean luminance of the image over seeds. `frames`: with a sample in each pixel.
Measured measure(const Scene& scene, const RenderSettings& settings, int frames = kFrames) {
  Session session(Scene(scene), settings);
  const int rendered = frames * settings.upscaling.factor * settings.upscaling.factor;
  return testing::mean_over_seeds(kSeeds, [&](int seed) {
    session.restart(seed);
    for (int i = 0; i < rendered; ++i) session.render_frame();
    double mean = 0;
    for (const Rgb& pixel : session.image().pixels) mean += static_cast<double>(luminance(pixel)) / (kSize * kSize);
    return mean;
  });
}

/// The mean by path tracing, which the tests of a process share. Scenes must have different names.
const Measured& mean_of_paths(const Scene& scene, RenderSettings settings, int frames) {
  static std::map<std::pair<std::string, int>, Measured> known;
  const auto [entry, is_new] = known.try_emplace(std::pair(scene.name, frames));
  if (is_new) {
    settings.estimator = EstimatorChoice::path;
    settings.reuse = ReuseChoice::none;
    settings.lights = LightSelectionChoice::power;
    settings.guide = GuideChoice::bsdf;
    settings.upscaling.factor = 1;
    entry->second = measure(scene, settings, frames);
  }
  return entry->second;
}

void expect_equal(const Measured& measured, const Measured& truth, EstimatorChoice estimator,
                  double most_error = kMostError) {
  const double error = error_of(measured, truth);
  const double bias = estimator == EstimatorChoice::vcm ? kBiasOfVcm : 0;
  EXPECT_LT(error, most_error * truth.mean);
  EXPECT_NEAR(measured.mean, truth.mean, 4.5 * error + (bias + kRounding) * truth.mean);
}

void expect_mean_of_paths(const Scene& scene, const RenderSettings& settings, int frames = kFrames,
                          double most_error = kMostError) {
  expect_equal(measure(scene, settings, frames), mean_of_paths(scene, settings, frames), settings.estimator,
               most_error);
}

using Pair = std::tuple<EstimatorChoice, ReuseChoice>;
class LightPaths : public ::testing::TestWithParam<Pair> {
 protected:
  static EstimatorChoice estimator() { return std::get<0>(GetParam()); }
  static ReuseChoice reuse() { return std::get<1>(GetParam()); }
  static RenderSettings settings() { return settings_of(estimator(), reuse()); }
};

std::string pair_name(const ::testing::TestParamInfo<Pair>& info) {
  const auto& [estimator, reuse] = info.param;
  const std::string first =
      estimator == EstimatorChoice::bdpt ? "bdpt" : (estimator == EstimatorChoice::light ? "light" : "vcm");
  return first + (reuse == ReuseChoice::ris ? "_ris" : "_restir_di");
}
auto all_pairs() {
  return ::testing::Combine(::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm),
                            ::testing::Values(ReuseChoice::ris, ReuseChoice::restir_di));
}
INSTANTIATE_TEST_SUITE_P(WithReservoirs, LightPaths, all_pairs(), pair_name);

TEST_P(LightPaths, HaveTheMeanOfPathTracing) { expect_mean_of_paths(glossy_room(), settings()); }

class SlowLightPaths : public LightPaths {};
INSTANTIATE_TEST_SUITE_P(Slow, SlowLightPaths, all_pairs(), pair_name);

TEST_P(SlowLightPaths, HaveTheMeanOfPathTracing) {
  for (const Scene& scene : {matte_room(), glossy_room()}) {
    SCOPED_TRACE(scene.name);
    expect_mean_of_paths(scene, settings(), kSlowFrames, kMostSlowError);
  }
}

/// With one bounce, all light but that of the lamps in view comes from reservoirs. A large radius would let merging
/// count it, too.
TEST_P(LightPaths, CountDirectLightOnce) {
  RenderSettings alone = settings_of(EstimatorChoice::path, reuse());
  alone.path.max_bounces = 1;
  RenderSettings both = settings();
  both.path.max_bounces = 1;
  both.vcm.radius = 0.05f;
  const Measured measured = measure(glossy_room(), both, 2 * kFrames);
  const Measured expected = measure(glossy_room(), alone, 2 * kFrames);
  EXPECT_LT(error_of(measured, expected), 0.02 * expected.mean);
  EXPECT_NEAR(measured.mean, expected.mean, 4.5 * error_of(measured, expected));
}

/// No reservoir takes a constant environment.
TEST_P(LightPaths, KeepTheLightOfAConstantEnvironment) {
  expect_equal(measure(find_builtin_scene("furnace")->build(), settings()), {.mean = 1}, estimator());
}

/// If no selection samples the environment, the directions of paths are the only candidates with its light.
TEST_P(LightPaths, FindAnEnvironmentByTheDirectionsOfPaths) {
  Scene scene = testing::plate(testing::matte(Rgb(0.5f)), 3, 1);
  scene.environment.kind = EnvironmentKind::map;
  scene.environment.width = 8;
  scene.environment.height = 4;
  for (int i = 0; i < 32; ++i) scene.environment.map.push_back(Rgb(i % 8 < 4 ? 1.0f : 0.2f));
  RenderSettings unsampled = settings();
  unsampled.light_selection.environment = false;
  expect_mean_of_paths(scene, unsampled);
}

TEST_P(LightPaths, KeepTheMeanWithFewerSamplesThanPixels) {
  RenderSettings upscaled = settings();
  testing::apply(testing::FewerPaths::upscaled, upscaled);
  expect_mean_of_paths(glossy_room(), upscaled);
}

/// The rate applies to the estimator "path" only, so densities must not contain it.
TEST_P(LightPaths, IgnoreTheRateOfIndirectLight) {
  const auto image_at = [](RenderSettings s, float rate) {
    s.path.indirect_rate = rate;
    Session session(glossy_room(), s);
    for (int i = 0; i < 2; ++i) session.render_frame();
    return session.image().pixels;
  };
  EXPECT_EQ(image_at(settings(), 0.5f), image_at(settings(), 1.0f));
}

class LearningLightPaths : public ::testing::TestWithParam<EstimatorChoice> {};
INSTANTIATE_TEST_SUITE_P(WithReservoirs, LearningLightPaths,
                         ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm), [](const auto& test) {
                           return std::string(test.param == EstimatorChoice::bdpt ? "bdpt" : "vcm");
                         });

TEST_P(LearningLightPaths, HaveTheMeanOfPathTracing) {
  RenderSettings settings = settings_of(GetParam(), ReuseChoice::restir_di);
  settings.lights = LightSelectionChoice::vlc;
  settings.guide = GuideChoice::cdq;
  expect_mean_of_paths(glossy_room(), settings);
}

/// Light tracing guides light subpaths alone, so the directions of its camera subpaths have the density of the BSDF.
TEST(GuidedLightTracing, HasTheMeanOfPathTracing) {
  RenderSettings settings = settings_of(EstimatorChoice::light, ReuseChoice::ris);
  settings.guide = GuideChoice::cdq;
  settings.cdq.importance = true;
  expect_mean_of_paths(glossy_room(), settings);
}

/// Numbers of wavelengths among the receivers of a frame.
size_t count_wavelengths(EstimatorChoice estimator) {
  Material frosted = glass("frosted", 1.5f);
  frosted.roughness = 0.2f;
  frosted.dispersion = 20;
  Session session(two_lamps("frosted room", frosted), settings_of(estimator, ReuseChoice::restir_di));
  session.render_frame();
  std::set<float> wavelengths;
  for (const ReceiverRecord& receiver : buffer_table(session).read(BufferKey<ReceiverRecord>{"restir-receivers"})) {
    if (receiver.valid()) wavelengths.insert(receiver.wavelength_nm);
  }
  return wavelengths.size();
}

/// The density of a recorded direction belongs to the wavelength of its path.
TEST(ReceiversOfLightPaths, HaveTheWavelengthsOfTheirPaths) {
  EXPECT_GT(count_wavelengths(EstimatorChoice::bdpt), 100u);
  EXPECT_EQ(count_wavelengths(EstimatorChoice::vcm), 1u);
}

/// The camera paths of light tracing find no indirect light.
TEST(LightPathsAreRefused, WithReservoirsOfIndirectLightByLightTracing) {
  for (const ReuseChoice reuse : {ReuseChoice::restir_gi, ReuseChoice::restir_di_gi, ReuseChoice::restir_pt}) {
    const std::string reason = refusal(settings_of(EstimatorChoice::light, reuse));
    EXPECT_NE(reason.find("its camera paths end at their first surface"), std::string::npos) << reason;
  }
}

TEST(LightPathsAreRefused, WithReservoirsOfPaths) {
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    for (const ReuseChoice reuse : {ReuseChoice::restir_gi, ReuseChoice::restir_di_gi})
      EXPECT_EQ(refusal(settings_of(estimator, reuse)), "");
    const std::string reason = refusal(settings_of(estimator, ReuseChoice::restir_pt));
    EXPECT_NE(reason.find("its connections to light subpaths is not implemented"), std::string::npos) << reason;
  }
}

TEST(LightPathsCombine, WithReservoirsAndACache) {
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    for (const ReuseChoice reuse : {ReuseChoice::restir_gi, ReuseChoice::restir_di_gi}) {
      RenderSettings settings = settings_of(estimator, reuse);
      for (const CacheChoice cache : {CacheChoice::psf, CacheChoice::apsf}) {
        settings.cache = cache;
        EXPECT_EQ(refusal(settings), "");
      }
      settings.cache = CacheChoice::apg;
      EXPECT_NE(refusal(settings).find("MIS weights depend on all earlier vertices"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace relume
