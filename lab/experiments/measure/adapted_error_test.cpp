#include "experiments/measure/adapted_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <random>

#include "experiments/measure/adaptation.h"
#include "experiments/measure/adapted_file.h"
#include "experiments/setup/learning_scenes.h"
#include "files/atomic_file.h"

namespace relume {
namespace {

TEST(AdaptedError, MeasuresTheImageOfEachContender) {
  const ExperimentScene scene = learning_scene("cornell");
  RenderSettings settings = scene.settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 1;
  RenderSettings cache = settings;
  cache.lights = LightSelectionChoice::vlc;
  RenderSettings lists = settings;
  lists.lights = LightSelectionChoice::static_lists;
  lists.static_lists.rays = 64;  // their preparation would dominate the test's time
  const std::vector<AdaptedError> errors =
      measure_adapted({}, scene, {{"plain", settings}, {"vlc", cache}, {"lists", lists}}, {.image = Image(16, 12)},
                      {mask_of({"image"}, 16, 12)}, {.warm_up = 1, .frames = 4, .sessions = 2, .block = 2, .seed = 1});
  ASSERT_EQ(errors.size(), 3u);
  for (const AdaptedError& e : errors) {
    ASSERT_EQ(e.mse[0].size(), e.name == "lists" ? 2u : 4u);  // one or two blocks per session
    EXPECT_EQ(e.frame_s.size(), 8u);
    EXPECT_NE(e.mse[0].front(), e.mse[0].back());  // different seeds
    EXPECT_GT(e.mean_mse(), 0);
    EXPECT_GT(e.median_s(), 0);
    EXPECT_GT(e.rays, 1);  // at least the camera ray of each pixel
    EXPECT_LT(e.rays, 20);
    EXPECT_FALSE(e.pass_s.empty());
  }
  EXPECT_EQ(errors[1].name, "vlc");
  EXPECT_FALSE(errors[1].figures.empty());
}

TEST(AdaptedError, CountsSessionsOfReservoirsOnce) {
  const ExperimentScene scene = learning_scene("cornell");
  RenderSettings settings = scene.settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 1;
  RenderSettings reservoirs = settings;
  reservoirs.reuse = ReuseChoice::restir_di;
  const std::vector<AdaptedError> errors =
      measure_adapted({}, scene, {{"plain", settings}, {"restir-di", reservoirs}}, {.image = Image(16, 12)},
                      {mask_of({"image"}, 16, 12)}, {.warm_up = 2, .frames = 4, .sessions = 3, .block = 2, .seed = 1});
  EXPECT_EQ(errors[0].mse[0].size(), 6u);
  EXPECT_EQ(errors[1].mse[0].size(), 3u) << "frames show samples of earlier ones";
  EXPECT_GT(errors[1].rays, errors[0].rays);
}

TEST(AdaptedError, ReusesStoredMeasurements) {
  ExperimentContext context;
  context.parts_folder = std::filesystem::temp_directory_path() / "relume_adapted_error_test";
  std::filesystem::remove_all(context.parts_folder);
  const ExperimentScene scene = learning_scene("cornell");
  RenderSettings settings = scene.settings;
  settings.width = 16;
  settings.height = 12;
  settings.lights = LightSelectionChoice::vlc;
  const std::vector<NamedSettings> contenders{{"vlc", settings}};
  const std::vector<PixelMask> regions{mask_of({"image"}, 16, 12)};
  AdaptedOptions options{.warm_up = 1, .frames = 2, .sessions = 1, .block = 1, .seed = 1};
  const auto measure = [&] {
    return measure_adapted(context, scene, contenders, {.image = Image(16, 12)}, regions, options);
  };
  const std::vector<AdaptedError> first = measure();
  const std::vector<AdaptedError> again = measure();
  ASSERT_EQ(again.size(), 1u);
  EXPECT_EQ(again[0].frame_s, first[0].frame_s);
  EXPECT_EQ(again[0].rays, first[0].rays);
  EXPECT_EQ(again[0].mse, first[0].mse);
  EXPECT_EQ(again[0].pass_s, first[0].pass_s);
  ASSERT_EQ(again[0].figures.size(), first[0].figures.size());
  EXPECT_EQ(again[0].figures[0].value, first[0].figures[0].value);
  EXPECT_EQ(again[0].last.pixels, first[0].last.pixels);
  // Changed conditions require a new measurement.
  context.program = "another";
  EXPECT_FALSE(load_adapted(adapted_file(context, scene, contenders, regions, options)));
  context.program.clear();
  options.seed = 2;
  EXPECT_FALSE(load_adapted(adapted_file(context, scene, contenders, regions, options)));
  options.seed = 1;
  write_file(adapted_file(context, scene, contenders, regions, options), "something else");
  EXPECT_FALSE(load_adapted(adapted_file(context, scene, contenders, regions, options)));
  std::filesystem::remove_all(context.parts_folder);
}

TEST(Adaptation, IsComparedWithThePlateauOfEachRun) {
  // The second run is twice as bright, which does not change ratios.
  const Adaptation a{"a", {{9, 5, 3, 1.5, 1, 1, 1, 1}, {18, 10, 6, 3, 2, 2, 2, 2}}};
  EXPECT_DOUBLE_EQ(a.plateau(4), 1.5);
  EXPECT_DOUBLE_EQ(a.over_plateau(0, 1).value, 9);
  EXPECT_DOUBLE_EQ(a.over_plateau(1, 2).value, 4);
  EXPECT_DOUBLE_EQ(a.over_plateau(1, 2).interval.low, 4);
  EXPECT_DOUBLE_EQ(a.over_plateau(1, 2).interval.high, 4);
  EXPECT_DOUBLE_EQ(a.over_plateau(6, 100).value, 1);  // limited to the existing frames
}

/// Sixteen runs of 64 frames with 20 % noise per frame. The error is `first` times the plateau's until frame `until`.
Adaptation noisy_adaptation(double first, size_t until, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(1, 0.2);
  Adaptation a{"a", {}};
  for (int run = 0; run < 16; ++run) {
    a.runs.emplace_back();
    for (size_t frame = 0; frame < 64; ++frame) a.runs.back().push_back((frame < until ? first : 1) * noise(random));
  }
  return a;
}

TEST(Adaptation, IsJudgedDespiteNoise) {
  int held = 0;
  int failed = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    held += judged_adapted("a", "p", "c", noisy_adaptation(3, 8, seed), 11).verdict == kVerdictHolds ? 1 : 0;
    failed += judged_adapted("a", "p", "c", noisy_adaptation(1.5, 30, seed), 11).verdict == kVerdictFails ? 1 : 0;
  }
  EXPECT_GE(held, 18);
  EXPECT_GE(failed, 18);
}

AdaptedError timed(std::vector<double> mse, std::vector<double> frame_s) {
  AdaptedError e;
  e.mse = {std::move(mse)};
  e.frame_s = std::move(frame_s);
  return e;
}

TEST(EqualTimeRatio, AccountsForTimesAndTheirVariation) {
  const std::vector<double> large{8.0, 8.1, 7.9, 8.0};
  const std::vector<double> small{1.0, 1.1, 0.9, 1.0};
  const Ratio errors = error_ratio(large, small);
  const Ratio even = equal_time_ratio(timed(large, {1, 1, 1, 1, 1, 1, 1, 1}), timed(small, {2, 2, 2, 2, 2, 2, 2, 2}));
  EXPECT_DOUBLE_EQ(even.value, errors.value / 2);
  EXPECT_NEAR(even.interval.low, errors.interval.low / 2, 1e-12);
  EXPECT_NEAR(even.interval.high, errors.interval.high / 2, 1e-12);
  const Ratio uneven = equal_time_ratio(timed(large, {1, 1, 1, 1}), timed(small, {1, 2, 2, 3}));
  EXPECT_DOUBLE_EQ(uneven.value, even.value);
  EXPECT_LT(uneven.interval.low, even.interval.low);
  EXPECT_GT(uneven.interval.high, even.interval.high);
}

}  // namespace
}  // namespace relume
