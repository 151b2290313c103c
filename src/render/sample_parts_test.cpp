#include "render/sample_parts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "render/summed_layers.h"
#include "render/testing/summing_settings.h"

namespace relume {
namespace {

using testing::summing_settings;

Session cornell(const RenderSettings& settings) { return Session(find_builtin_scene("cornell")->build(), settings); }

void render(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) session.render_frame();
}

TEST(SampleParts, NameTheTechniquesWithoutSums) {
  const auto reason = [](const auto& change) {
    RenderSettings settings;
    change(settings);
    return sums_refusal(settings);
  };
  EXPECT_EQ(reason([](RenderSettings&) {}), "");
  EXPECT_EQ(reason([](RenderSettings& s) { s.estimator = EstimatorChoice::vcm; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.history = HistoryChoice::none; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.history = HistoryChoice::reproject; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.denoise = DenoiseChoice::svgf; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.cache = CacheChoice::psf; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.allocation = AllocationChoice::adaptive; }), "");
  EXPECT_NE(reason([](RenderSettings& s) { s.upscaling.factor = 2; }), "");
  RenderSettings denoised = summing_settings();
  denoised.denoise = DenoiseChoice::svgf;
  EXPECT_THROW(plan(denoised), Error);
}

TEST(SampleParts, ImageIsTheMeanUpToRounding) {
  RenderSettings settings = summing_settings();
  settings.auxiliary = true;
  Session summed = cornell(settings);
  settings.samples.sums = false;
  Session plain = cornell(settings);
  render(summed, 21);
  render(plain, 21);
  const Image a = summed.image();
  const Image b = plain.image();
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(a.pixels[i][c], b.pixels[i][c], 2e-6f * b.pixels[i][c] + 1e-7f);
  }
  for (const char* layer : {"variance", "albedo", "normal", "depth", "heatmap", "samples", "motion"}) {
    const std::vector<ExrChannel> x = summed.aov(layer);
    const std::vector<ExrChannel> y = plain.aov(layer);
    ASSERT_EQ(x.size(), y.size()) << layer;
    for (size_t p = 0; p < x.size(); ++p) {
      EXPECT_EQ(x[p].name, y[p].name);
      for (size_t i = 0; i < x[p].values.size(); ++i)
        EXPECT_NEAR(x[p].values[i], y[p].values[i], 1e-4f * std::abs(y[p].values[i]) + 1e-6f) << x[p].name;
    }
  }
}

TEST(SampleParts, SummingKeepsTheBitsOfTheHistory) {
  RenderSettings settings = summing_settings();
  Session summed = cornell(settings);
  settings.samples.sums = false;
  Session plain = cornell(settings);
  render(summed, 5);
  render(plain, 5);
  for (const char* name : {"mean", "samples"}) {
    const BufferData a = summed.buffer(name);
    const BufferData b = plain.buffer(name);
    EXPECT_TRUE(std::equal(a.bytes.begin(), a.bytes.end(), b.bytes.begin(), b.bytes.end())) << name;
  }
  EXPECT_EQ(summed.estimated_error(), plain.estimated_error());
}

TEST(SampleParts, CountFromTheirFirstSample) {
  RenderSettings settings = summing_settings();
  settings.samples.part = true;
  settings.samples.first = 48;
  Session session = cornell(settings);
  EXPECT_EQ(session.frames_since_change(), 0u);
  EXPECT_EQ(rendered_samples(session).count, 0u);
  for (const Rgb& pixel : session.image().pixels) EXPECT_EQ(pixel, Rgb(0));
  render(session, 3);
  EXPECT_EQ(session.image_frames(), 3u);
  EXPECT_EQ(session.image_samples(), 3);
  EXPECT_EQ(session.frames_since_change(), 3u);
  EXPECT_EQ(session.statistics().frames, 3u);
  EXPECT_EQ(rendered_samples(session).first, 48u);
  EXPECT_EQ(rendered_samples(session).count, 3u);
  const Image before = session.image();
  session.restart(settings.seed);
  render(session, 3);
  EXPECT_EQ(session.image().pixels, before.pixels);
}

TEST(SampleParts, ContinueFromCheckpoints) {
  const TempFolder folder;
  RenderSettings settings = summing_settings();
  settings.samples.part = true;
  settings.samples.first = 32;
  Session whole = cornell(settings);
  render(whole, 20);
  Session first = cornell(settings);
  render(first, 7);
  first.save_checkpoint(folder / "a.ckpt");
  Session second = cornell(settings);
  second.load_checkpoint(folder / "a.ckpt");
  render(second, 13);
  EXPECT_EQ(second.image().pixels, whole.image().pixels);
  settings.samples.first = 0;
  Session other = cornell(settings);
  EXPECT_THROW(other.load_checkpoint(folder / "a.ckpt"), Error);
}

TEST(SampleParts, StartOverAfterAChange) {
  RenderSettings settings = summing_settings();
  Session session = cornell(settings);
  render(session, 20);
  settings.path.max_bounces = 1;
  ASSERT_TRUE(session.set_settings(settings));
  render(session, 4);
  Session fresh = cornell(settings);
  render(fresh, 4);
  EXPECT_EQ(rendered_samples(session).count, 4u);
  const Image a = session.image();
  const Image b = fresh.image();
  double mean_a = 0;
  double mean_b = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) {
    mean_a += static_cast<double>(luminance(a.pixels[i]));
    mean_b += static_cast<double>(luminance(b.pixels[i]));
  }
  EXPECT_NEAR(mean_a / mean_b, 1, 0.2) << "earlier samples are still in the sums";
}

}  // namespace
}  // namespace relume
