// Tests light selection and guiding that learn from paths of which a radiance cache replaces parts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "metrics/statistics.h"
#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"
#include "support/technique_checks.h"

namespace relume::support {
namespace {

/// Why tests are skipped on a device.
constexpr const char* kOnTheHost = "the same bits as on the host, which takes long";

/// All settings of what learns that differ from the defaults.
RenderSettings all_departures(RenderSettings s) {
  s.octree = {.collapse = 32, .split = 64, .scale = false, .count = OctreeCount::useful, .vertices = 4, .jitter = 1};
  s.lights = LightSelectionChoice::vlc;
  s.vlc.memory = 0;
  s.vlc.bucket_size = 4;
  s.vlc.infinite = CachedInfinity::entries;
  s.vlc.change_measure = ChangeMeasure::amount;
  s.vlc.learn_exploration = true;
  s.guide = GuideChoice::cdq;
  s.cdq.bits = QuadtreeBits::b64;
  s.cdq.migrations = 4;
  s.cdq.learn_fraction = true;
  s.cdq.pool = 256;
  s.cdq.candidates = 4;
  s.cdq.memory = 8;
  s.cdq.spread = 1;
  s.cdq.sampling = QuadtreeSampling::stratified;
  s.apsf.min_samples = 16;
  return s;
}

/// Mean luminance of images of `seeds` seeds, each of 24 frames, and its standard error.
struct Brightness {
  double mean = 0;
  double error = 0;
};
Brightness brightness(const RenderSettings& settings, int seeds) {
  const Moments moments = measure(open_box(), settings, 24, seeds, 1);
  std::vector<double> means;
  for (const Image& image : moments.images) means.push_back(mean_luminance(image));
  return {mean(means), standard_deviation(means) / std::sqrt(static_cast<double>(seeds))};
}

RenderSettings plain_settings() { return small_settings(24, 16); }

/// Of path tracing, rendered once per process for all caches.
const Brightness& plain_brightness() {
  static const Brightness result = brightness(plain_settings(), 48);
  return result;
}

class CachedLearning : public ::testing::TestWithParam<CacheChoice> {};

/// The combination table tests the same with the default settings, while the camera moves.
TEST_P(CachedLearning, AllSettingsKeepTheMean) {
  if (is_host_replaced()) GTEST_SKIP() << kOnTheHost;
  const char* const names[] = {"none", "psf", "apsf", "apg", "apsf+apg"};
  const double bias = technique_checks().biases.at(std::string("cache=") + names[static_cast<int>(GetParam())]);
  RenderSettings settings = all_departures(plain_settings());
  settings.cache = GetParam();
  const Brightness& expected = plain_brightness();
  const Brightness found = brightness(settings, 32);
  const double error = std::hypot(found.error, expected.error) / expected.mean;
  EXPECT_LT(error, 0.01) << "too noisy to tell";
  EXPECT_NEAR(found.mean / expected.mean, 1.0, bias + 4.5 * error);
}

/// Value of a pass's statistic; fails the test if it is missing.
double statistic(const Session& session, const std::string& name) {
  const auto all = session.statistics().pass_statistics;
  const auto found = std::find_if(all.begin(), all.end(), [&](const PassStatistic& s) { return s.name == name; });
  EXPECT_TRUE(found != all.end()) << name;
  return found == all.end() ? 0.0 : found->value;
}

TEST_P(CachedLearning, RegionsLearnLights) {
  RenderSettings settings = all_departures(small_settings(64, 48));
  settings.octree.collapse = 16;
  settings.octree.split = 32;
  settings.cache = GetParam();
  Session session(open_box(), settings);  // every region sees several lights
  for (int i = 0; i < 16; ++i) session.render_frame();
  EXPECT_GT(statistic(session, "vlc.regions"), 8.0);
  EXPECT_GT(statistic(session, "vlc.lights-a-region"), 1.0);
  EXPECT_GT(statistic(session, "octree.samples"), 64.0 * 48 / 20);  // a cache follows a tenth of the paths or more
}

std::string cache_name(const ::testing::TestParamInfo<CacheChoice>& instance) {
  const char* const names[] = {"none", "psf", "apsf", "apg", "apsf_apg"};
  return names[static_cast<int>(instance.param)];
}
INSTANTIATE_TEST_SUITE_P(Caches, CachedLearning,
                         ::testing::Values(CacheChoice::psf, CacheChoice::apsf, CacheChoice::apg,
                                           CacheChoice::apsf_apg),
                         cache_name);

/// Mean MSE of single frames [first, last) of three seeds.
double error_of_frames(const Scene& scene, RenderSettings settings, const Image& reference, int first, int last) {
  constexpr int kSeeds = 3;
  settings.history = HistoryChoice::none;
  double sum = 0;
  for (settings.seed = 1; settings.seed <= kSeeds; ++settings.seed) {
    Session session(scene, settings);
    for (int frame = 0; frame < last; ++frame) {
      session.render_frame();
      if (frame >= first) sum += mse(session.image(), reference);
    }
  }
  return sum / (kSeeds * (last - first));
}

TEST(SlowCachedLearning, LightCacheHalvesTheErrorOfAFilterAmongHiddenLamps) {
  if (is_host_replaced()) GTEST_SKIP() << kOnTheHost;
  const Scene scene = find_builtin_scene("warehouse")->build();
  RenderSettings settings = small_settings(256, 144);  // smaller images show the blur of cells, which both have
  settings.lights = LightSelectionChoice::vlc;
  const Image reference = render(scene, settings, 96);
  settings.cache = CacheChoice::psf;
  const double vlc = error_of_frames(scene, settings, reference, 0, 8);
  settings.lights = LightSelectionChoice::power;
  const double power = error_of_frames(scene, settings, reference, 0, 8);
  RecordProperty("ratio", std::to_string(vlc / power));
  EXPECT_LT(vlc, 0.5 * power);
}

/// Light reaches the camera by three bends.
TEST(SlowCachedLearning, GuidedPathGraphsHaveLessErrorThanEachAloneInACorridor) {
  if (is_host_replaced()) GTEST_SKIP() << kOnTheHost;
  const Scene scene = find_builtin_scene("corridor")->build();
  RenderSettings settings = small_settings(64, 36);
  settings.path.max_bounces = 10;
  settings.octree = {.collapse = 128, .split = 256, .scale = false};  // more regions than the first eight
  settings.estimator = EstimatorChoice::bdpt;
  const Image reference = render(scene, settings, 2048);
  settings.estimator = EstimatorChoice::path;
  const auto error = [&](CacheChoice cache, GuideChoice guide) {
    RenderSettings s = settings;
    s.cache = cache;
    s.guide = guide;
    return error_of_frames(scene, s, reference, 24, 48);
  };
  const double both = error(CacheChoice::apg, GuideChoice::cdq);
  const double graph = error(CacheChoice::apg, GuideChoice::bsdf);
  const double guided = error(CacheChoice::none, GuideChoice::cdq);
  RecordProperty("over-graph", std::to_string(both / graph));
  RecordProperty("over-guided", std::to_string(both / guided));
  EXPECT_LT(both, graph);
  EXPECT_LT(both, guided);
}

}  // namespace
}  // namespace relume::support
