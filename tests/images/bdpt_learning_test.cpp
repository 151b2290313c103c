// Tests bidirectional path tracing, and vertex connection and merging, with learned lights and directions.
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "experiments/measure/ratio.h"
#include "support/image_test.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

constexpr int kImages = 16;
constexpr int kFrames = 8;  ///< each learns from the previous ones

struct Way {
  std::string name;
  RenderSettings settings;
  ImageTestOptions options{.detectable = 0.25, .detectable_mean = 0.2};
};

/// Small regions, so that small images have many.
RenderSettings base_settings() {
  RenderSettings s = small_settings(24, 16);
  s.octree = {.collapse = 32, .split = 64, .scale = false};
  return s;
}

std::vector<Way> ways() {
  std::vector<Way> list;
  const auto add = [&](const char* name, EstimatorChoice estimator, LightSelectionChoice lights, GuideChoice guide) {
    Way way{name, base_settings()};
    way.settings.estimator = estimator;
    way.settings.lights = lights;
    way.settings.guide = guide;
    list.push_back(way);
  };
  add("bdpt-vlc", EstimatorChoice::bdpt, LightSelectionChoice::vlc, GuideChoice::bsdf);
  add("bdpt-cdq", EstimatorChoice::bdpt, LightSelectionChoice::power, GuideChoice::cdq);
  add("bdpt-departures", EstimatorChoice::bdpt, LightSelectionChoice::vlc, GuideChoice::cdq);
  RenderSettings& all = list.back().settings;
  all.vlc.memory = 0;
  all.vlc.learn_exploration = true;
  all.cdq.learn_fraction = true;
  all.cdq.candidates = 4;
  all.cdq.sampling = QuadtreeSampling::stratified;
  all.octree.vertices = 4;
  all.octree.jitter = 1;
  all.octree.count = OctreeCount::useful;
  add("bdpt-importance", EstimatorChoice::bdpt, LightSelectionChoice::power, GuideChoice::cdq);
  list.back().settings.cdq.importance = true;
  list.back().settings.cdq.memory = 4;
  list.back().settings.octree.vertices = 4;
  add("vcm-vlc-cdq", EstimatorChoice::vcm, LightSelectionChoice::vlc, GuideChoice::cdq);
  list.back().settings.cdq.importance = true;
  list.back().settings.vcm.radius = 0.01f;
  // The blur of merging is a bias, largest for pixels at edges.
  list.back().options.pixels = false;
  list.back().options.tolerance = 0.02;
  return list;
}

class BdptLearning : public ::testing::TestWithParam<std::string_view> {};

TEST_P(BdptLearning, AgreesWithPathTracing) {
  const Scene scene = find_builtin_scene(GetParam())->build();
  const Moments expected = measure(scene, base_settings(), 2 * kFrames, kImages, 1001);
  int seed = 1;
  for (const Way& way : ways()) {
    expect_same_image(way.name + "-" + std::string(GetParam()), measure(scene, way.settings, kFrames, kImages, seed),
                      expected, way.options);
    seed += kImages;
  }
}

std::string scene_name(const ::testing::TestParamInfo<std::string_view>& info) {
  return test_name(std::string(info.param));
}
INSTANTIATE_TEST_SUITE_P(Builtin, BdptLearning, ::testing::Values("cornell", "turntable"), scene_name);

TEST(LightTracingLearning, AgreesWithPathTracing) {
  const Scene scene = find_builtin_scene("cornell")->build();
  RenderSettings guided = base_settings();
  guided.estimator = EstimatorChoice::light;
  guided.guide = GuideChoice::cdq;
  guided.cdq.importance = true;
  guided.cdq.memory = 4;
  guided.octree.vertices = 4;
  expect_same_image("light-importance", measure(scene, guided, kFrames, kImages, 1),
                    measure(scene, base_settings(), 2 * kFrames, kImages, 1001),
                    {.detectable = 0.25, .detectable_mean = 0.2});
}

/// Mean squared deviation of each image from the mean of all: the error of an unbiased technique, without a reference.
std::vector<double> errors_of(const Moments& moments) {
  std::vector<double> errors;
  for (const Image& image : moments.images) errors.push_back(mse(image, moments.mean_image()));
  return errors;
}

TEST(SlowBdptLearning, TheLightCacheDoesNotRaiseTheErrorInALampRoom) {
  const Scene scene = find_builtin_scene("lamp-room")->build();
  RenderSettings settings = small_settings(32, 24);
  settings.estimator = EstimatorChoice::bdpt;
  settings.octree = {.collapse = 128, .split = 256, .scale = false};
  const std::vector<double> plain = errors_of(measure(scene, settings, 64, 24, 1));
  settings.lights = LightSelectionChoice::vlc;
  const Ratio ratio = paired_error_ratio(errors_of(measure(scene, settings, 64, 24, 1)), plain);
  RecordProperty("ratio", to_text(ratio));
  EXPECT_LE(ratio.interval.low, 1.1) << to_text(ratio);
  EXPECT_LT(ratio.interval.high, 3 * ratio.interval.low) << "too noisy to say anything: " << to_text(ratio);
}

}  // namespace
}  // namespace relume::support
