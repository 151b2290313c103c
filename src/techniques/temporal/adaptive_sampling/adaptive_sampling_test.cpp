#include "techniques/temporal/adaptive_sampling/paper_allocation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "framebuffer/testing/moment_vectors.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "techniques/temporal/adaptive_sampling/adaptive_sampling_pass.h"

namespace relume {
namespace {

struct Pixels {
  explicit Pixels(uint32_t n) : history(n, {Rgb(1), 0, 0, 0}), probability(n, 0), noise(n, 0), allocation(n, 0) {}

  /// Number of samples in one frame.
  uint32_t allocate(uint32_t iteration, uint32_t frame = 0, bool scene_changed = false) {
    PaperAllocationKernel k;
    k.history = history.view();
    k.probability = mutable_view_of(probability);
    k.noise = mutable_view_of(noise);
    k.allocation = mutable_view_of(allocation);
    k.iteration = iteration;
    k.scene_changed = scene_changed;
    k.min_samples = 4;
    k.max_samples = 32;
    k.seed = 5;
    k.frame = frame;
    k.width = static_cast<uint32_t>(allocation.size());
    uint32_t sum = 0;
    for (uint32_t x = 0; x < k.width; ++x) {
      k(x, 0);
      sum += allocation[x];
    }
    return sum;
  }

  testing::MomentVectors history;
  std::vector<float> probability;
  std::vector<float> noise;
  std::vector<uint32_t> allocation;
};

TEST(AdaptiveSampling, NoiseIsTheRelativeStandardDeviation) {
  // Grey samples 1 and 3: mean 2, variance 2.
  EXPECT_NEAR(adaptive_noise({Rgb(2), 2, 6, 2}), std::sqrt(2.0f) / 2.0f, 1e-3f);
  EXPECT_FLOAT_EQ(adaptive_noise({Rgb(0), 0, 0, 4}), 1.0f);                            // black so far: counts as noise
  EXPECT_GT(adaptive_noise({Rgb(0.1f), 1, 3, 4}), adaptive_noise({Rgb(1), 1, 3, 4}));  // dark regions come first
}

TEST(AdaptiveSampling, ThresholdFallsLinearlyFromOneToZero) {
  EXPECT_EQ(adaptive_threshold(0, 4, 32), 1.0f);
  EXPECT_EQ(adaptive_threshold(4, 4, 32), 1.0f);
  EXPECT_FLOAT_EQ(adaptive_threshold(18, 4, 32), 0.5f);
  EXPECT_EQ(adaptive_threshold(32, 4, 32), 0.0f);
  EXPECT_EQ(adaptive_threshold(99, 4, 32), 0.0f);
}

TEST(AdaptiveSampling, EveryPixelGetsTheMinimum) {
  Pixels p(3);
  p.history.samples = {3, 4, 4};
  p.history.m2_rgb = {0, 0, 300};
  p.allocate(4);
  EXPECT_EQ(p.allocation, (std::vector<uint32_t>{1, 0, 1}));
}

TEST(AdaptiveSampling, NoisyPixelsComeFirst) {
  Pixels p(2);
  p.history.samples = {8, 8};
  p.history.m2_rgb = {0.21f, 21};  // standard deviations 0.1 and 1
  p.allocate(18);
  EXPECT_EQ(p.allocation, (std::vector<uint32_t>{0, 1}));
}

TEST(AdaptiveSampling, ProbabilityIsTheShareOfSamplesTaken) {
  Pixels p(4);
  p.history.samples = {4, 16, 32, 40};
  p.allocate(32);
  EXPECT_EQ(p.probability, (std::vector<float>{0.125f, 0.5f, 1.0f, 1.0f}));
}

TEST(AdaptiveSampling, SamplesFollowTheProbability) {
  // 4000 pixels of probability 1/4: mean 1000, standard deviation 27.
  Pixels p(4000);
  std::fill(p.history.samples.begin(), p.history.samples.end(), 50u);
  std::fill(p.probability.begin(), p.probability.end(), 0.25f);
  const uint32_t first = p.allocate(40, 7);
  EXPECT_NEAR(first, 1000, 5 * 27);
  const std::vector<uint32_t> chosen = p.allocation;
  p.allocate(40, 8);
  EXPECT_NE(p.allocation, chosen);  // other pixels in the next frame
}

TEST(AdaptiveSampling, ReprojectedPixelsWaitForTheOthers) {
  Pixels p(2);
  p.history.samples = {20, 8};
  p.history.m2_rgb = {300, 300};
  p.probability = {0.6f, 0.0f};
  p.allocate(10);
  EXPECT_EQ(p.allocation, (std::vector<uint32_t>{0, 1}));
}

// A view in continuous motion stays at iteration 0.
TEST(AdaptiveSampling, NothingIsFrozenWhileTheViewMoves) {
  // 4000 pixels of probability 1/4: mean 1000, standard deviation 27.
  Pixels p(4000);
  std::fill(p.history.samples.begin(), p.history.samples.end(), 50u);
  std::fill(p.probability.begin(), p.probability.end(), 0.25f);
  EXPECT_NEAR(p.allocate(0), 1000, 5 * 27);
  std::fill(p.probability.begin(), p.probability.end(), 0.0f);  // not yet settled: all pixels
  EXPECT_EQ(p.allocate(0), 4000u);
}

TEST(AdaptiveSampling, ProbabilitiesDoNotOutliveAChangeOfTheScene) {
  Pixels p(2);
  p.history.samples = {20, 20};
  p.probability = {0.25f, 1.0f};
  p.allocate(0, 0, true);
  EXPECT_EQ(p.allocation, (std::vector<uint32_t>{1, 1}));
  EXPECT_EQ(p.probability, (std::vector<float>{0, 0}));
}

TEST(AdaptiveSampling, RejectsMaximumNotAboveMinimum) {
  RenderSettings settings;
  settings.adaptive.min_samples = 64;
  for (const int max : {8, 64}) {
    settings.adaptive.max_samples = max;
    settings.allocation = AllocationChoice::uniform;
    EXPECT_NO_THROW(check_combination(settings));  // unused
    settings.allocation = AllocationChoice::adaptive;
    EXPECT_THROW(check_combination(settings), Error) << max;
  }
  settings.adaptive.max_samples = 65;
  EXPECT_NO_THROW(check_combination(settings));
}

TEST(AdaptiveSampling, AnAbandonedFrameDoesNotEndThePilot) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.allocation = AllocationChoice::adaptive;
  settings.adaptive.pilot = true;
  settings.adaptive.max_samples = 6;
  Session session(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < 6; ++i) session.render_frame();
  std::stop_source stop;
  stop.request_stop();
  const double pilot_samples = session.kept_samples();
  EXPECT_FALSE(session.render_frame(stop.get_token()));
  EXPECT_EQ(session.kept_samples(), pilot_samples);
  EXPECT_TRUE(session.render_frame());
  EXPECT_EQ(session.kept_samples(), 1);
}

TEST(AdaptiveSampling, ThePilotLeavesReprojectedHistories) {
  for (const ReprojectionMethod method : {ReprojectionMethod::forward, ReprojectionMethod::backward}) {
    RenderSettings settings;
    settings.width = 16;
    settings.height = 12;
    settings.allocation = AllocationChoice::adaptive;
    settings.adaptive.pilot = true;
    settings.adaptive.max_samples = 6;
    settings.history = HistoryChoice::reproject;
    settings.reproject.method = method;
    Session session(find_builtin_scene("cornell")->build(), settings);
    for (int i = 0; i < 7; ++i) session.render_frame();
    EXPECT_EQ(session.kept_samples(), 1);
    const View<const uint32_t> allocation = buffer_table(session).view(kAllocation);
    EXPECT_EQ(std::count(allocation.begin(), allocation.end(), 1u), allocation.size);
    CameraPose camera = session.camera();
    camera.to_world[3].x += 0.05f;
    session.set_camera(camera);
    session.render_frame();
    EXPECT_GT(session.kept_samples(), 1);
    EXPECT_LE(session.kept_samples(), 2) << "one sample after the pilot, and this frame's";
  }
}

TEST(AdaptiveSampling, ProbabilitiesAreUpdatedAboutOncePerSample) {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.allocation = AllocationChoice::adaptive;
  settings.adaptive.rate = 0.25f;
  Session session(find_builtin_scene("cornell")->build(), settings);
  std::vector<float> before;
  std::vector<uint32_t> changed_in;
  for (uint32_t frame = 0; frame < 17; ++frame) {
    session.render_frame();
    const View<const float> view = buffer_table(session).view(kSamplingProbability);
    const std::vector<float> now(view.begin(), view.end());
    if (now != before) changed_in.push_back(frame);
    before = now;
  }
  EXPECT_EQ(changed_in, (std::vector<uint32_t>{0, 2, 3, 4, 8, 12, 16})) << "two samples are the first that tell";
}

/// Mean probability of a sample after 17 frames of a built-in scene.
double average_rate(const char* scene, float least) {
  RenderSettings settings;
  settings.width = 32;
  settings.height = 24;
  settings.allocation = AllocationChoice::adaptive;
  settings.adaptive.rate = least;
  Session session(find_builtin_scene(scene)->build(), settings);
  for (int i = 0; i < 17; ++i) session.render_frame();
  const View<const float> view = buffer_table(session).view(kSamplingProbability);
  return std::accumulate(view.begin(), view.end(), 0.0) / static_cast<double>(view.size);
}

TEST(AdaptiveSampling, EvenNoiseRaisesTheRate) {
  EXPECT_GT(average_rate("cornell-closed", 0.05f), 0.4);
  EXPECT_LT(average_rate("cornell", 0.05f), 0.3) << "its background has no noise";
}

TEST(AdaptiveSampling, SettingIsTheMinimumRate) {
  for (const float least : {0.35f, 0.6f}) EXPECT_NEAR(average_rate("cornell", least), least, 0.02);
}

TEST(AdaptiveSampling, ImagesWithoutNoiseGetASampleEverywhere) { EXPECT_EQ(average_rate("furnace", 0.25f), 1.0); }

}  // namespace
}  // namespace relume
