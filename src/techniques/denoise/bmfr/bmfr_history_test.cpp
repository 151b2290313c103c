// Histories of the denoiser.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "techniques/denoise/bmfr/bmfr.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 77;  // not a multiple of a block
constexpr uint32_t kHeight = 45;
constexpr uint32_t kPixels = kWidth * kHeight;

/// Light on one plane, at rest or in motion.
struct History {
  History() {
    for (uint32_t i = 0; i < kPixels; ++i)
      position[i] = Vec3(static_cast<float>(i % kWidth), static_cast<float>(i / kWidth), 0);
  }

  void accumulate(uint32_t max_samples, float least_share = 0) {
    light.swap(light_before);
    count.swap(count_before);
    square.swap(square_before);
    BmfrAccumulateKernel kernel;
    kernel.history.reprojection = {
        view_of(motion),   view_of(came_from), view_of(normal),         view_of(depth), view_of(surface),
        view_of(position), view_of(normal),    view_of(surface_before), kWidth,         kHeight};
    for (uint32_t i = 0; i < kPixels; ++i) scattered[i] = radiance[i] - emission[i];
    kernel.history.samples = samples();
    kernel.history.light_before = view_of(light_before);
    kernel.history.count_before = view_of(count_before);
    kernel.fitted_before = view_of(light_before);
    kernel.square_before = view_of(square_before);
    kernel.history.light = mutable_view_of(light);
    kernel.history.count = mutable_view_of(count);
    kernel.fitted_history = mutable_view_of(fitted_history);
    kernel.square = mutable_view_of(square);
    kernel.age = mutable_view_of(age);
    kernel.history.max_samples = max_samples;
    kernel.history.least_share = least_share;
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
    }
  }

  SurfaceLight samples() const {
    return {view_of(radiance), view_of(scattered), view_of(allocation), view_of(albedo), view_of(emission)};
  }

  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> came_from = std::vector<Vec3>(kPixels);
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<Vec2> motion = std::vector<Vec2>(kPixels, Vec2(0));
  std::vector<float> depth = std::vector<float>(kPixels, 10.0f);
  std::vector<uint32_t> surface = std::vector<uint32_t>(kPixels, 0);
  std::vector<uint32_t> surface_before = surface;
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<Rgb> emission = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<Rgb> radiance = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<Rgb> scattered = radiance;
  std::vector<uint32_t> allocation = std::vector<uint32_t>(kPixels, 1);
  std::vector<Rgb> light = std::vector<Rgb>(kPixels, Rgb(0));
  std::vector<Rgb> light_before = light;
  std::vector<Rgb> fitted_history = light;
  std::vector<float> square = std::vector<float>(kPixels, 0.0f);
  std::vector<float> square_before = square;
  std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, 0);
  std::vector<uint32_t> count_before = count;
  std::vector<uint32_t> age = count;
};

TEST(Bmfr, StillPixelsKeepTheMeanOfTheirSamples) {
  History h;
  for (int frame = 1; frame <= 5; ++frame) {
    h.radiance.assign(kPixels, Rgb(static_cast<float>(frame)));
    h.accumulate(kNoHistoryLimit);
  }
  EXPECT_EQ(h.count[17], 5u);
  EXPECT_NEAR(h.light[17].r, 3.0f / 0.5f, 1e-5f);  // mean over albedo
  EXPECT_NEAR(h.square[17], 11.0f / 0.25f, 1e-3f);
  EXPECT_EQ(h.age[17], 4u);
  h.accumulate(3);  // limits the history to three samples
  EXPECT_EQ(h.count[17], 4u);
  EXPECT_NEAR(h.light[17].r, (3.0f * 6.0f + 10.0f) / 4.0f, 1e-5f);
}

TEST(Bmfr, FirstAccumulationOfThePaperAveragesFiveFramesThenFadesThem) {
  History h;
  float expected = 0;
  for (int frame = 1; frame <= 12; ++frame) {
    h.radiance.assign(kPixels, Rgb(static_cast<float>(frame)));
    h.accumulate(kNoHistoryLimit, 0.2f);
    const float weight = frame < 5 ? 1.0f / static_cast<float>(frame) : 0.2f;
    expected += (static_cast<float>(frame) / 0.5f - expected) * weight;
    EXPECT_NEAR(h.light[17].r, expected, 1e-4f) << frame;
  }
  EXPECT_EQ(h.count[17], 12u);  // fits are averaged over more frames than the light
}

TEST(Bmfr, FadingLightCountsByItsVariance) {
  EXPECT_EQ(independent_samples(0), kInfinity);
  EXPECT_EQ(independent_samples(1), 1.0f);
  History h;
  std::mt19937 generator(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int frame = 0; frame < 40; ++frame) {
    for (Rgb& radiance : h.radiance) radiance = Rgb(0.5f * uniform(generator));  // light in [0, 1)
    h.accumulate(kNoHistoryLimit, 0.2f);
  }
  double squared = 0;
  for (const Rgb& light : h.light) squared += static_cast<double>(sqr(light.g - 0.5f)) / kPixels;
  const double of_one = 1.0 / 12;
  // The variance of 3465 such numbers is known to 2.4 %; the tolerance is four times that.
  EXPECT_NEAR(of_one / squared / static_cast<double>(independent_samples(0.2f)), 1.0, 0.1);
}

TEST(Bmfr, LightFollowsItsSurface) {
  History h;
  for (uint32_t i = 0; i < kPixels; ++i) h.radiance[i] = Rgb(static_cast<float>(i % kWidth));
  h.accumulate(kNoHistoryLimit);
  // The image moves three pixels to the right.
  h.motion.assign(kPixels, Vec2(3, 0));
  for (uint32_t i = 0; i < kPixels; ++i) h.came_from[i] = h.position[i] - Vec3(3, 0, 0);
  for (Rgb& radiance : h.radiance) radiance = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  const uint32_t row = 20 * kWidth;
  for (uint32_t x = 3; x < kWidth; ++x) {
    EXPECT_EQ(h.count[row + x], 2u);
    EXPECT_NEAR(h.light[row + x].r, static_cast<float>(x - 3), 1e-4f);  // half of (x − 3) / albedo
  }
  EXPECT_EQ(h.count[row + 1], 1u);  // entered at the border
}

TEST(Bmfr, BlackTexelsDoNotAffectNeighbouringHistories) {
  History h;
  const uint32_t black = 20 * kWidth + 20;
  h.albedo[black] = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  h.motion.assign(kPixels, Vec2(0.5f, 0));  // each pixel was between two
  for (uint32_t i = 0; i < kPixels; ++i) h.came_from[i] = h.position[i] - Vec3(0.5f, 0, 0);
  h.accumulate(kNoHistoryLimit);
  EXPECT_EQ(h.count[black - 1], 2u);
  EXPECT_EQ(h.count[black + 1], 2u);
  EXPECT_NEAR(h.light[black + 1].r, 2.0f, 1e-5f);
}

TEST(Bmfr, OtherSurfacesHaveNoHistory) {
  History h;
  h.accumulate(kNoHistoryLimit);
  h.surface.assign(kPixels, 7);
  h.accumulate(kNoHistoryLimit);
  EXPECT_EQ(h.count[100], 1u);
}

TEST(Bmfr, NonFiniteAndMissingSamplesKeepTheHistory) {
  History h;
  h.accumulate(kNoHistoryLimit);
  const Rgb known = h.light[0];
  h.radiance[0] = Rgb(std::numeric_limits<float>::quiet_NaN());
  h.radiance[1] = Rgb(0, kInfinity, 0);
  h.allocation[2] = 0;
  h.radiance[2] = Rgb(0);
  h.accumulate(kNoHistoryLimit);
  for (uint32_t i = 0; i < 3; ++i) {
    EXPECT_EQ(h.count[i], 1u);
    EXPECT_EQ(h.light[i], known);
  }
  EXPECT_EQ(h.count[3], 2u);
}

TEST(Bmfr, EmissionAndBlackSurfacesAreNotFiltered) {
  History h;
  h.emission.assign(kPixels, Rgb(0.75f));
  h.accumulate(kNoHistoryLimit);
  EXPECT_NEAR(h.light[5].g, 0.5f, 1e-6f);  // (1 − 0.75) / 0.5
  const SurfaceLight samples = h.samples();
  EXPECT_NEAR(samples.image(5, h.light[5]).g, 1.0f, 1e-6f);
  EXPECT_EQ(samples.image(5, Rgb(-2)), Rgb(0));  // samples missed the lamp: clamped to black
  h.albedo[5] = Rgb(0);
  EXPECT_FALSE(samples.at(5).valid);
  EXPECT_EQ(samples.image(5, Rgb(100)), Rgb(1));  // the sample itself
  h.allocation[5] = 0;
  EXPECT_EQ(samples.image(5, Rgb(100)), Rgb(0.75f));
}

}  // namespace
}  // namespace relume
