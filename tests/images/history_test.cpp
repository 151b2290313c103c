// Tests histories and sample allocation against the converged image: unbiased ones agree with it, others stay within
// the bounds stated on their pages.
#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "support/image_test.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kSize = 32;
constexpr int kSeeds = 16;
constexpr int kPilotFrames = 48;  // the first half determines the allocation
constexpr int kPilotImages = 96;

Scene cornell() { return find_builtin_scene("cornell")->build(); }

RenderSettings settings_of(AllocationChoice allocation, HistoryChoice history, int size = kSize) {
  RenderSettings s = small_settings(size, size);
  s.allocation = allocation;
  s.history = history;
  s.adaptive.max_samples = 24;
  return s;
}

/// The scene's camera, moved `shift` metres to its right.
CameraPose moved(const Session& session, float shift) {
  CameraPose camera = session.camera();
  camera.to_world[3] += shift * camera.to_world[0];
  return camera;
}

/// Images after the camera returned to its position: five steps aside with `frames` at each, and five back.
Moments after_a_walk(const RenderSettings& settings, int frames, int last_frames, int seeds = kSeeds) {
  std::vector<Image> images;
  for (int seed = 1; seed <= seeds; ++seed) {
    RenderSettings seeded = settings;
    seeded.seed = seed;
    Session session(cornell(), seeded);
    const CameraPose start = session.camera();
    const auto stay = [&](int count) {
      for (int i = 0; i < count; ++i) session.render_frame();
    };
    stay(frames);
    for (int step = 1; step <= 5; ++step) {
      session.set_camera(moved(session, 0.15f));
      stay(frames);
    }
    for (int step = 1; step <= 5; ++step) {
      session.set_camera(step == 5 ? start : moved(session, -0.15f));
      stay(step == 5 ? last_frames : frames);
    }
    images.push_back(session.image());
  }
  return moments_of(std::move(images));
}

/// Rendered once, in the process of all tests of its suite.
const Moments& reference() {
  static const Moments images =
      measure(cornell(), settings_of(AllocationChoice::uniform, HistoryChoice::accumulate), 96, kSeeds, 1001);
  return images;
}

/// Reference for the scene with the largest bias from allocation by averaged samples.
const Moments& reference_of_the_open_box() {
  static const Moments images =
      measure(open_box(), settings_of(AllocationChoice::uniform, HistoryChoice::accumulate, 24), 2 * kPilotFrames,
              kPilotImages, 1001);
  return images;
}

double mean_of(const Moments& m) { return mean_luminance(m.mean_image()); }

/// Mean over images and pixels of the squared difference from the mean of `truth`, with radiance clamped to 1 as on a
/// display.
double mse_of(const Moments& m, const Moments& truth) {
  double sum = 0;
  for (const Image& image : m.images) {
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      const Rgb difference = glm::min(image.pixels[i], Rgb(1)) - glm::min(truth.mean[i], Rgb(1));
      sum += static_cast<double>(length_squared(difference)) / 3.0;
    }
  }
  return sum / static_cast<double>(m.images.size() * m.mean.size());
}

TEST(SharedHistory, ReprojectionWithoutMovesIsAccumulation) {
  expect_same_image(
      "reproject-still", reference(),
      measure(cornell(), settings_of(AllocationChoice::uniform, HistoryChoice::reproject), 64, kSeeds, 1));
}

constexpr ImageTestOptions kPilotOptions{.detectable = 0.02, .detectable_mean = 0.015};

Moments pilot_images(AdaptiveMethod method, bool pilot, int count = kPilotImages) {
  RenderSettings s = settings_of(AllocationChoice::adaptive, HistoryChoice::accumulate, 24);
  s.adaptive.method = method;
  s.adaptive.pilot = pilot;
  return measure(open_box(), s, kPilotFrames, count, 1);
}

/// With half of the images, the least detectable errors grow by at most the square root of two.
TEST(SharedHistory, AdaptiveSamplingWithPilotSamplesHasNoBias) {
  expect_same_image("adaptive-pilot-paper", pilot_images(AdaptiveMethod::paper, true, kPilotImages / 2),
                    reference_of_the_open_box(), {.detectable = 0.029, .detectable_mean = 0.0215});
}
TEST(SlowHistory, AdaptiveSamplingWithPilotSamplesHasNoBias) {
  expect_same_image("adaptive-pilot-paper-sharp", pilot_images(AdaptiveMethod::paper, true),
                    reference_of_the_open_box(), kPilotOptions);
  // The same comparison detects the bias without a pilot.
  const ImageTest without =
      compare(pilot_images(AdaptiveMethod::paper, false), reference_of_the_open_box(), kPilotOptions);
  EXPECT_GT(without.rejected_means, 0) << without.report();
}

/// Even without a pilot, this method has no bias that shows.
TEST(SlowHistory, PooledDeviationsWithPilotSamplesHaveNoBias) {
  expect_same_image("adaptive-pilot-pooled", pilot_images(AdaptiveMethod::pooled, true), reference_of_the_open_box(),
                    kPilotOptions);
}

/// A pixel's own values are excluded from its estimate. With half of the images, the least detectable errors grow by
/// the square root of 1.5, because the reference contributes a part of them.
TEST(SharedHistory, PooledDeviationsLeaveNoBiasThatShows) {
  expect_same_image("adaptive-pooled", pilot_images(AdaptiveMethod::pooled, false, kPilotImages / 2),
                    reference_of_the_open_box(), {.detectable = 0.025, .detectable_mean = 0.019});
}
TEST(SlowHistory, PooledDeviationsLeaveNoBiasThatShows) {
  expect_same_image("adaptive-pooled-sharp", pilot_images(AdaptiveMethod::pooled, false), reference_of_the_open_box(),
                    kPilotOptions);
}

TEST(SharedHistory, AdaptiveSamplingIsBiasedByLessThanTwoPercent) {
  for (const AdaptiveMethod method : {AdaptiveMethod::pooled, AdaptiveMethod::paper}) {
    RenderSettings s = settings_of(AllocationChoice::adaptive, HistoryChoice::accumulate);
    s.adaptive.method = method;
    EXPECT_NEAR(mean_of(measure(cornell(), s, 128, kSeeds / 4, 1)) / mean_of(reference()), 1.0, 0.02);
  }
}

TEST(SharedHistory, ReprojectionIsBiasedByLessThanTwoPercent) {
  for (const ReprojectionMethod method : {ReprojectionMethod::forward, ReprojectionMethod::backward}) {
    RenderSettings s = settings_of(AllocationChoice::uniform, HistoryChoice::reproject);
    s.reproject.method = method;
    EXPECT_NEAR(mean_of(after_a_walk(s, 4, 16, kSeeds / 4)) / mean_of(reference()), 1.0, 0.02);
  }
}

TEST(History, ReprojectionBeatsRestarting) {
  constexpr int kLarger = 96;  // at 32, every second pixel is on an edge, which reprojection rejects
  const auto settings = [](HistoryChoice history) { return settings_of(AllocationChoice::uniform, history, kLarger); };
  const Moments truth = measure(cornell(), settings(HistoryChoice::accumulate), 64, 2, 1001);
  const auto walk = [&](HistoryChoice history) { return mse_of(after_a_walk(settings(history), 4, 1, 4), truth); };
  EXPECT_LT(walk(HistoryChoice::reproject), 0.6 * walk(HistoryChoice::accumulate));
}

TEST(History, NoneShowsTheLatestSampleOnly) {
  Session session(cornell(), settings_of(AllocationChoice::uniform, HistoryChoice::none));
  session.render_frame();
  const Image first = session.image();
  session.render_frame();
  EXPECT_NE(session.image().pixels, first.pixels);
  EXPECT_EQ(buffer_table(session).read(kSamples)[0], 1u);
  EXPECT_EQ(session.frames_since_change(), 2u);
  EXPECT_EQ(session.kept_samples(), 1);
}

TEST(History, KeptSamplesDifferFromFramesUnderAllocationOrReprojection) {
  constexpr int kFrames = 64;
  Session adaptive(cornell(), settings_of(AllocationChoice::adaptive, HistoryChoice::accumulate));
  for (int i = 0; i < kFrames; ++i) adaptive.render_frame();
  EXPECT_GT(adaptive.kept_samples(), 1);
  EXPECT_LT(adaptive.kept_samples(), kFrames);

  Session walk(cornell(), settings_of(AllocationChoice::uniform, HistoryChoice::reproject));
  for (int i = 0; i < kFrames; ++i) walk.render_frame();
  EXPECT_EQ(walk.kept_samples(), kFrames);
  walk.set_camera(moved(walk, 0.05f));
  walk.render_frame();
  EXPECT_EQ(walk.frames_since_change(), 1u);
  EXPECT_GT(walk.kept_samples(), 1);
}

}  // namespace
}  // namespace relume::support
