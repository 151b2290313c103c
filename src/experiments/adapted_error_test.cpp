#include "experiments/adapted_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "experiments/adaptation.h"
#include "experiments/learning_scenes.h"

namespace relume {
namespace {

TEST(AdaptedError, CountsThePixelsOfARegionOnly) {
  Image reference(2, 1);
  Image frame(2, 1);
  frame.pixels = {Rgb(1, 2, 3), Rgb(30)};
  EXPECT_DOUBLE_EQ(frame_mse(frame, reference, {"left", {1, 0}}), (1.0 + 4 + 9) / 3);
  EXPECT_DOUBLE_EQ(frame_mse(frame, reference, whole_picture(2, 1)), (1.0 + 4 + 9 + 2700) / 6);
}

TEST(AdaptedError, TheReferencesNoiseIsThatOfTheRegion) {
  Reference reference;
  EXPECT_EQ(reference_noise(reference, whole_picture(2, 1)), 0);
  reference.squared_error = Image(2, 1);
  reference.squared_error.pixels = {Rgb(1, 2, 3), Rgb(30)};
  EXPECT_DOUBLE_EQ(reference_noise(reference, {"left", {1, 0}}), 2);
  EXPECT_DOUBLE_EQ(reference_noise(reference, whole_picture(2, 1)), 16);
}

TEST(AdaptedError, RatiosHaveIntervalsThatNarrowWithFrames) {
  std::vector<double> a;
  std::vector<double> b;
  for (int i = 0; i < 16; ++i) {
    a.push_back(8 + (i % 2 == 0 ? 1 : -1));
    b.push_back(2 + (i % 2 == 0 ? -0.2 : 0.2));
  }
  const ErrorRatio few = error_ratio(a, b);
  EXPECT_DOUBLE_EQ(few.value, 4);
  EXPECT_LT(few.interval.low, 4);
  EXPECT_GT(few.interval.high, 4);
  for (int i = 0; i < 2; ++i) {
    a.insert(a.end(), a.begin(), a.end());
    b.insert(b.end(), b.begin(), b.end());
  }
  const ErrorRatio many = error_ratio(a, b);
  EXPECT_NEAR(std::log(few.interval.high / 4) / std::log(many.interval.high / 4), 2, 0.1);  // four times as many
}

TEST(AdaptedError, MeasuresWhatEachContenderShows) {
  const ExperimentScene scene = builtin_scene("cornell");
  RenderSettings settings = scene.settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 1;
  RenderSettings cache = settings;
  cache.lights = LightSelectionChoice::vlc;
  const std::vector<AdaptedError> errors =
      measure_adapted({}, scene, {{"plain", settings}, {"vlc", cache}}, {.image = Image(16, 12)},
                      {whole_picture(16, 12)}, {.warm_up = 1, .frames = 3, .seed = 1});
  ASSERT_EQ(errors.size(), 2u);
  for (const AdaptedError& e : errors) {
    EXPECT_EQ(e.mse[0].size(), 3u);
    EXPECT_NE(e.mse[0][1], e.mse[0][2]);  // single frames, not their mean
    EXPECT_GT(e.mean_mse(), 0);
    EXPECT_GT(e.median_s(), 0);
    EXPECT_FALSE(e.pass_s.empty());
  }
  EXPECT_EQ(errors[1].name, "vlc");
  EXPECT_FALSE(errors[1].figures.empty());
}

TEST(Adaptation, EndsWhereTheCurveStaysNearItsPlateau) {
  Adaptation a;
  a.mse = {9, 5, 3, 1.05, 1.05, 1.05, 1, 1, 1, 1, 1, 1};
  EXPECT_DOUBLE_EQ(a.plateau(4), 1);
  EXPECT_EQ(a.adapted_after(0.1, 1), 3u);
  EXPECT_EQ(a.adapted_after(0.01, 1), 6u);
  EXPECT_EQ(a.adapted_after(0.1, 3), 3u);
  a.mse[5] = 4;  // a relapse
  EXPECT_EQ(a.adapted_after(0.1, 1), 6u);
}

TEST(LearningScenes, TellTheMinesRegionsApart) {
  Image reference(4, 1);
  Image direct(4, 1);
  direct.pixels = {Rgb(10), Rgb(0.1f), Rgb(0), Rgb(0.5f)};
  reference.pixels = {Rgb(11), Rgb(3), Rgb(0), Rgb(0.6f)};
  const std::vector<PictureRegion> regions = mine_regions(reference, direct, {"surfaces", {1, 1, 1, 0}});
  ASSERT_EQ(regions.size(), 4u);
  EXPECT_EQ(regions[1].mask, (std::vector<uint8_t>{1, 0, 0, 0}));
  EXPECT_EQ(regions[2].mask, (std::vector<uint8_t>{0, 1, 0, 0}));
  EXPECT_EQ(regions[3].mask, (std::vector<uint8_t>{0, 0, 1, 0}));
}

}  // namespace
}  // namespace relume
