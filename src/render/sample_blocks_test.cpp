#include "render/sample_blocks.h"

#include <bit>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/sample_parts.h"
#include "render/session.h"
#include "render/summed_layers.h"
#include "render/testing/summing_settings.h"

namespace relume {
namespace {

constexpr size_t kPixels = size_t{16} * 12;

RenderSettings settings_with_layers() {
  RenderSettings settings = testing::summing_settings();
  settings.auxiliary = true;
  return settings;
}

Session cornell(const RenderSettings& settings) { return Session(find_builtin_scene("cornell")->build(), settings); }

void render(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) session.render_frame();
}

void expect_same_image(const Session& a, const Session& b) {
  const Image x = a.image();
  const Image y = b.image();
  ASSERT_EQ(x.pixels.size(), y.pixels.size());
  EXPECT_EQ(std::memcmp(x.pixels.data(), y.pixels.data(), x.pixels.size() * sizeof(Rgb)), 0);
  for (const char* layer : {"variance", "albedo", "normal", "depth", "heatmap", "samples", "motion"}) {
    const std::vector<ExrChannel> left = a.aov(layer);
    const std::vector<ExrChannel> right = b.aov(layer);
    ASSERT_EQ(left.size(), right.size()) << layer;
    for (size_t c = 0; c < left.size(); ++c) {
      ASSERT_EQ(left[c].values.size(), right[c].values.size());
      const size_t bytes = left[c].values.size() * sizeof(float);
      EXPECT_EQ(std::memcmp(left[c].values.data(), right[c].values.data(), bytes), 0) << left[c].name;
    }
  }
}

TEST(SampleBlocks, OfOneSessionInAnyOrderAreOneRender) {
  Session whole = cornell(settings_with_layers());
  render(whole, 40);
  Session parts = cornell(settings_with_layers());
  std::vector<PixelSums> total(kPixels);
  const auto add = [&](uint32_t first, int frames) {
    begin_samples(parts, first);
    render(parts, frames);
    take_samples(parts, total);
  };
  add(32, 8);
  add(0, 16);
  add(16, 16);
  // Layers of one frame: motion is that of the first sample, others are those of the last.
  begin_samples(parts, 0);
  render(parts, 1);
  skip_samples(parts, 39);
  render(parts, 1);
  set_samples(parts, total, 40);
  expect_same_image(parts, whole);
  EXPECT_EQ(parts.statistics().rays, whole.statistics().rays);
  EXPECT_EQ(parts.image_samples(), 40);
}

TEST(SampleBlocks, AreOneRenderForAllTechniquesThatDoNotAdapt) {
  std::vector<RenderSettings> list;
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm}) {
    list.push_back(settings_with_layers());
    list.back().estimator = estimator;
  }
  list.push_back(settings_with_layers());
  list.back().reuse = ReuseChoice::ris;
  list.push_back(settings_with_layers());
  list.back().stratify = false;
  for (const RenderSettings& settings : list) {
    SCOPED_TRACE(&settings - list.data());
    ASSERT_FALSE(samples_adapt(settings));
    Session whole = cornell(settings);
    render(whole, 24);
    Session parts = cornell(settings);
    std::vector<PixelSums> total(kPixels);
    for (const uint32_t first : {16u, 0u}) {
      begin_samples(parts, first);
      render(parts, first == 0 ? 16 : 8);
      take_samples(parts, total);
    }
    std::vector<PixelSums> expected(kPixels);
    take_samples(whole, expected);
    EXPECT_EQ(std::memcmp(total.data(), expected.data(), kPixels * sizeof(PixelSums)), 0);
  }
}

TEST(SampleBlocks, ContinueAfterTheirSumsAreTaken) {
  Session whole = cornell(settings_with_layers());
  render(whole, 32);
  Session parts = cornell(settings_with_layers());
  std::vector<PixelSums> total(kPixels);
  begin_samples(parts, 0);
  for (int i = 0; i < 2; ++i) {
    render(parts, 16);
    take_samples(parts, total);
  }
  std::vector<PixelSums> expected(kPixels);
  take_samples(whole, expected);
  EXPECT_EQ(std::memcmp(total.data(), expected.data(), kPixels * sizeof(PixelSums)), 0);
}

TEST(SampleBlocks, TheErrorOfSumsIsThatOfTheSession) {
  Session session = cornell(settings_with_layers());
  render(session, 32);
  const double expected = session.estimated_error();
  std::vector<PixelSums> sums(kPixels);
  take_samples(session, sums);
  EXPECT_NEAR(relative_error(sums, {{0, 0, 16, 12}, 16, 32, 1}), expected, 1e-4 * expected);
}

}  // namespace
}  // namespace relume
