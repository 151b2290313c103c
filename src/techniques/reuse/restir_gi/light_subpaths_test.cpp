// Reservoirs of indirect light with samples from bidirectional paths: means against path tracing.
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"
#include "techniques/reuse/restir_gi/testing/large_lamps.h"
#include "techniques/reuse/restir_gi/testing/posts.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {
namespace {

using testing::error_of;
using testing::FewerPaths;
using testing::Measured;
using testing::under_large_lamps;

constexpr int kMoving = 6;
constexpr int kKept = 8;
constexpr int kSeeds = 20;
constexpr double kMostError = 0.02;  ///< largest standard error, relative
constexpr double kMostGlassError = 0.03;
constexpr double kMostSlowError = 0.015;
constexpr double kBiasOfVcm = 0.01;     ///< blur over the merging radius
constexpr double kBiasOfBlocks = 0.02;  ///< the same, for a block of the image

RenderSettings settings_of(EstimatorChoice estimator, ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.estimator = estimator;
  settings.restir.radius = 6;
  settings.restir.cap = settings.restir_gi.cap = 8;
  settings.path.max_bounces = 5;
  return settings;
}

/// The means by path tracing, after the same movements of the camera.
const std::vector<Measured>& means_of_paths(const Scene& scene) {
  static std::map<std::string, std::vector<Measured>> known;
  const auto [entry, is_new] = known.try_emplace(scene.name);
  if (is_new) {
    const RenderSettings settings = settings_of(EstimatorChoice::path, ReuseChoice::none);
    entry->second = testing::after_moves(scene, settings, 24, kMoving, 192);
  }
  return entry->second;
}

/// Compares the mean of the image, then those of its blocks.
void expect_mean_of_paths(const Scene& scene, const RenderSettings& settings, int seeds = kSeeds, int kept = kKept,
                          double most_error = kMostError) {
  const std::vector<Measured>& truth = means_of_paths(scene);
  const std::vector<Measured> reused = testing::after_moves(scene, settings, seeds, kMoving, kept);
  EXPECT_LT(error_of(reused[0], truth[0]), most_error * truth[0].mean);
  const bool merges = settings.estimator == EstimatorChoice::vcm;
  for (size_t k = 0; k < truth.size(); ++k) {
    // With few degrees of freedom, standard errors are uncertain.
    const double bias = merges ? (k == 0 ? kBiasOfVcm : kBiasOfBlocks) : 0;
    const double tolerance = (k == 0 ? 6 : 7) * error_of(reused[k], truth[k]) + bias * truth[k].mean + 1e-6;
    EXPECT_NEAR(reused[k].mean, truth[k].mean, tolerance) << (k == 0 ? "image" : "block ") << k;
  }
}

using Case = std::tuple<const char*, EstimatorChoice, ReuseChoice>;

std::string case_name(const ::testing::TestParamInfo<Case>& info) {
  const auto& [scene, estimator, reuse] = info.param;
  std::string name(scene);
  for (char& c : name) c = c == '-' ? '_' : c;
  name += estimator == EstimatorChoice::bdpt ? "_bdpt" : "_vcm";
  return name + (reuse == ReuseChoice::restir_gi ? "_gi" : "_di_gi");
}

class RestirGiOfSubpaths : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Scenes, RestirGiOfSubpaths,
                         ::testing::Values(Case{"cornell", EstimatorChoice::bdpt, ReuseChoice::restir_gi},
                                           Case{"cornell", EstimatorChoice::bdpt, ReuseChoice::restir_di_gi},
                                           Case{"cornell", EstimatorChoice::vcm, ReuseChoice::restir_gi},
                                           Case{"cornell", EstimatorChoice::vcm, ReuseChoice::restir_di_gi},
                                           Case{"cornell-glass", EstimatorChoice::bdpt, ReuseChoice::restir_gi},
                                           Case{"cornell-glass", EstimatorChoice::vcm, ReuseChoice::restir_di_gi},
                                           Case{"cornell-water", EstimatorChoice::bdpt, ReuseChoice::restir_di_gi},
                                           Case{"cornell-water", EstimatorChoice::vcm, ReuseChoice::restir_gi}),
                         case_name);

TEST_P(RestirGiOfSubpaths, HasTheMeanOfPathTracing) {
  const auto& [scene, estimator, reuse] = GetParam();
  const bool is_matte = std::string(scene) == "cornell";
  expect_mean_of_paths(under_large_lamps(scene), settings_of(estimator, reuse), kSeeds, kKept,
                       is_matte ? kMostError : kMostGlassError);
}

class SlowRestirGiOfSubpaths : public ::testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Slow, SlowRestirGiOfSubpaths,
                         ::testing::Combine(::testing::Values("cornell", "cornell-spheres", "cornell-glass",
                                                              "cornell-water"),
                                            ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm),
                                            ::testing::Values(ReuseChoice::restir_gi, ReuseChoice::restir_di_gi)),
                         case_name);

TEST_P(SlowRestirGiOfSubpaths, HasTheMeanOfPathTracing) {
  const auto& [scene, estimator, reuse] = GetParam();
  expect_mean_of_paths(under_large_lamps(scene), settings_of(estimator, reuse), 6 * kSeeds, kKept, kMostSlowError);
}

/// A smooth coat over all surfaces: second vertices scatter both kinds of light.
TEST(RestirGiOfSubpathsOnCoats, HasTheMeanOfPathTracing) {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.name = "coated";
  for (Material& m : scene.materials) {
    if (!is_black(m.emission)) continue;
    m.clearcoat = 1;
    m.clearcoat_roughness = 0;
  }
  expect_mean_of_paths(scene, settings_of(EstimatorChoice::bdpt, ReuseChoice::restir_di_gi));
}

/// A lens that light subpaths meet.
TEST(RestirGiOfSubpathsBehindALens, HasTheMeanOfPathTracing) {
  Scene scene = find_builtin_scene("cornell")->build();
  scene.name = "lens";
  scene.cameras[0].lens_radius = 0.5f;
  scene.cameras[0].focus_distance = 10;
  expect_mean_of_paths(scene, settings_of(EstimatorChoice::bdpt, ReuseChoice::restir_gi));
}

class LearningSubpaths : public ::testing::TestWithParam<EstimatorChoice> {};
INSTANTIATE_TEST_SUITE_P(RestirGi, LearningSubpaths, ::testing::Values(EstimatorChoice::bdpt, EstimatorChoice::vcm),
                         [](const auto& test) {
                           return std::string(test.param == EstimatorChoice::bdpt ? "bdpt" : "vcm");
                         });

TEST_P(LearningSubpaths, HaveTheMeanOfPathTracing) {
  RenderSettings settings = settings_of(GetParam(), ReuseChoice::restir_di_gi);
  settings.lights = LightSelectionChoice::vlc;
  settings.guide = GuideChoice::cdq;
  expect_mean_of_paths(under_large_lamps("cornell"), settings);
}

TEST_P(LearningSubpaths, HaveTheMeanOfPathTracingWithMarkovChains) {
  RenderSettings settings = settings_of(GetParam(), ReuseChoice::restir_gi);
  settings.lights = LightSelectionChoice::mcls;
  settings.guide = GuideChoice::mcpg;
  expect_mean_of_paths(under_large_lamps("cornell"), settings);
}

TEST_P(LearningSubpaths, HaveTheMeanOfPathTracingWithFewerPaths) {
  for (const FewerPaths fewer : {FewerPaths::upscaled, FewerPaths::adaptive_after_pilot}) {
    SCOPED_TRACE(testing::name_of(fewer));
    RenderSettings settings = settings_of(GetParam(), ReuseChoice::restir_gi);
    testing::apply(fewer, settings);
    expect_mean_of_paths(under_large_lamps("cornell"), settings, 48, 24);
  }
}

/// A session that records samples. Both estimators sample the same second vertices.
Session sampling_session(EstimatorChoice estimator) {
  RenderSettings settings = settings_of(estimator, ReuseChoice::restir_gi);
  settings.path.max_bounces = 4;
  settings.path.russian_roulette = false;
  return Session(find_builtin_scene("cornell")->build(), settings);
}

std::vector<IndirectSample> samples_of(Session& session, int seed) {
  session.restart(seed);
  session.render_frame();
  const View<const IndirectSample> samples = buffer_table(session).read(kIndirectSamples);
  return {samples.begin(), samples.end()};
}

/// The vertices and their densities are those of path tracing. Their light has the same mean, but connections find it.
TEST(SamplesOfSubpaths, HaveTheLightOfPathTracing) {
  constexpr int kRuns = 96;
  Session path_session = sampling_session(EstimatorChoice::path);
  Session subpath_session = sampling_session(EstimatorChoice::bdpt);
  std::vector<double> differences;
  double sum = 0;
  int compared = 0;
  int same_light = 0;
  for (int seed = 1; seed <= kRuns; ++seed) {
    const std::vector<IndirectSample> of_paths = samples_of(path_session, seed);
    const std::vector<IndirectSample> of_subpaths = samples_of(subpath_session, seed);
    double difference = 0;
    for (size_t p = 0; p < of_paths.size(); ++p) {
      const IndirectSample& a = of_subpaths[p];
      const IndirectSample& b = of_paths[p];
      ASSERT_EQ(a.vertex.instance, b.vertex.instance);
      ASSERT_EQ(a.vertex.primitive, b.vertex.primitive);
      ASSERT_NEAR(a.weight, b.weight, 1e-3f * b.weight);
      if (!(b.weight > 0.0f)) continue;
      ++compared;
      const auto light = static_cast<double>(luminance(b.vertex.radiance));
      difference += static_cast<double>(luminance(a.vertex.radiance)) - light;
      sum += light;
      same_light += a.vertex.radiance == b.vertex.radiance ? 1 : 0;
    }
    differences.push_back(difference);
  }
  const Measured difference = testing::measured_over(differences);
  const double mean = sum / kRuns;
  EXPECT_LT(difference.error, 0.01 * mean);
  EXPECT_NEAR(difference.mean, 0, 4.5 * difference.error);
  EXPECT_GT(compared, 100 * kRuns);
  EXPECT_LT(same_light, compared / 10);
}

/// Numbers of wavelengths among the receivers of a frame. That of a sample must be that of its receiver.
size_t count_wavelengths(EstimatorChoice estimator) {
  Scene scene = testing::posts();
  Material dispersive = glass("dispersive", 1.5f);
  dispersive.dispersion = 20;
  testing::add_mesh(scene, dispersive, box({2, 0.4f, -0.2f}, {2.4f, 0.6f, 0.2f}));
  Session session(std::move(scene), settings_of(estimator, ReuseChoice::restir_gi));
  session.render_frame();
  std::map<float, int> wavelengths;
  for (const ReceiverRecord& receiver : buffer_table(session).read(BufferKey<ReceiverRecord>{"restir-gi-receivers"})) {
    if (receiver.valid()) ++wavelengths[receiver.wavelength_nm];
  }
  return wavelengths.size();
}

TEST(ReceiversOfIndirectLight, HaveTheWavelengthsOfTheirPaths) {
  EXPECT_GT(count_wavelengths(EstimatorChoice::bdpt), 100u);
  EXPECT_EQ(count_wavelengths(EstimatorChoice::vcm), 1u);
}

}  // namespace
}  // namespace relume
