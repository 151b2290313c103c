// Tests of ReSTIR DI and GI in one frame.
#include <cmath>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "frame/pipeline.h"
#include "render/build_pipeline.h"
#include "techniques/reuse/reservoir/testing/fewer_paths.h"
#include "techniques/reuse/restir_gi/testing/image_means.h"

namespace relume {
namespace {

using testing::error_of;
using testing::FewerPaths;
using testing::Measured;

constexpr int kMoving = 6;
constexpr int kKept = 8;

RenderSettings settings_of(ReuseChoice reuse) {
  RenderSettings settings = testing::reuse_settings(reuse);
  settings.restir.radius = 6;
  settings.restir.cap = settings.restir_gi.cap = 8;
  settings.path.max_bounces = 4;
  return settings;
}

Scene box_scene() { return find_builtin_scene("cornell")->build(); }

/// The mean of many more samples than reuse has, after the same movements of the camera.
const std::vector<Measured>& reference() {
  static const std::vector<Measured> truth =
      testing::after_moves(box_scene(), settings_of(ReuseChoice::none), 12, kMoving, 96);
  return truth;
}

/// Compares the mean of the image over `seeds` runs of `kept` frames, then those of its blocks.
void expect_mean_of_paths(const RenderSettings& settings, int seeds = 20, int kept = kKept) {
  const std::vector<Measured> reused = testing::after_moves(box_scene(), settings, seeds, kMoving, kept);
  EXPECT_LT(error_of(reused[0], reference()[0]), 0.02 * reference()[0].mean);
  for (size_t k = 0; k < reference().size(); ++k) {
    // With few degrees of freedom, standard errors are uncertain.
    const double tolerance = (k == 0 ? 6 : 7) * error_of(reused[k], reference()[k]) + 1e-6;
    EXPECT_NEAR(reused[k].mean, reference()[k].mean, tolerance) << (k == 0 ? "image" : "block ") << k;
  }
}

/// Light that a direction meets at a lamp is that of ReSTIR DI only, and light from other surfaces that of ReSTIR GI.
TEST(RestirDiGi, HasTheMeanOfPathTracing) { expect_mean_of_paths(settings_of(ReuseChoice::restir_di_gi)); }

TEST(RestirDiGi, HasTheMeanWithLearnedLightsAndDirections) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.lights = LightSelectionChoice::vlc;
  settings.guide = GuideChoice::cdq;
  expect_mean_of_paths(settings);
}

TEST(RestirDiGi, HasTheMeanWithMarkovChainGuiding) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.guide = GuideChoice::mcpg;
  expect_mean_of_paths(settings);
}

TEST(RestirDiGi, HasTheMeanWithFewerIndirectPaths) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.path.indirect_rate = 0.5f;
  expect_mean_of_paths(settings);
}

TEST(RestirDiGi, HasTheMeanWithFewerPaths) {
  for (const FewerPaths fewer : {FewerPaths::upscaled, FewerPaths::adaptive_after_pilot}) {
    SCOPED_TRACE(testing::name_of(fewer));
    RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
    testing::apply(fewer, settings);
    expect_mean_of_paths(settings, 48, 24);
  }
}

/// Luminance of the pixels of the third frame.
std::vector<float> third_frame(RenderSettings settings) {
  settings.history = HistoryChoice::none;
  settings.path.russian_roulette = false;  // whose numbers depend on the light that is taken from the path
  Session session(box_scene(), settings);
  for (int i = 0; i < 3; ++i) session.render_frame();
  std::vector<float> values;
  const Image image = session.image();
  for (const Rgb& pixel : image.pixels) values.push_back(luminance(pixel));
  return values;
}

/// Number of pixels that differ by more than rounding, which narrow lobes amplify.
int differing(const std::vector<float>& a, const std::vector<float>& b) {
  int count = 0;
  for (size_t p = 0; p < a.size(); ++p) count += std::fabs(a[p] - b[p]) > 1e-3f * (1.0f + b[p]) ? 1 : 0;
  return count;
}

/// Without reuse, reservoirs of indirect light give back the light that they take from the path.
TEST(RestirDiGi, IsRestirDiWithoutReuseOfIndirectLight) {
  const std::vector<float> direct = third_frame(settings_of(ReuseChoice::restir_di));
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.restir_gi.cap = settings.restir_gi.neighbours = 0;
  const int pixels = static_cast<int>(direct.size());
  EXPECT_LE(differing(third_frame(settings), direct), pixels / 50);
  EXPECT_GT(differing(third_frame(settings_of(ReuseChoice::restir_di_gi)), direct), pixels / 4);
}

/// With one bounce, there is no indirect light.
TEST(RestirDiGi, IsRestirDiWithOneBounce) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.path.max_bounces = 1;
  const std::vector<float> both = third_frame(settings);
  settings.reuse = ReuseChoice::restir_di;
  EXPECT_EQ(both, third_frame(settings));
}

/// Frames depend on each other as those of the longer history.
TEST(RestirDiGi, HasTheCorrelationOfTheLongerHistory) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  settings.restir.cap = 4;
  settings.restir_gi.cap = 20;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 41u);
  settings.restir.cap = 30;
  EXPECT_EQ(build_passes(settings, host_memory()).pipeline.correlated_frames(), 61u);
}

/// Bytes per pixel of the buffers of reservoirs and of their candidates.
uint32_t bytes_per_pixel(const RenderSettings& settings) {
  uint32_t bytes = 0;
  for (const PassDeclaration& pass : build_passes(settings, host_memory()).pipeline.declarations()) {
    for (const BufferDescription& buffer : pass.owns) {
      const std::string_view name = buffer.id.name;
      if (name.starts_with("restir") || name == "first-scatters" || name == "indirect-samples")
        bytes += buffer.id.element_bytes * (buffer.double_buffered ? 2u : 1u);
    }
  }
  return bytes;
}

/// README.md states these numbers.
TEST(RestirDiGi, NeedsTheMemoryOfBoth) {
  RenderSettings settings = settings_of(ReuseChoice::restir_di_gi);
  EXPECT_EQ(bytes_per_pixel(settings), 580u);
  settings.reuse = ReuseChoice::restir_di;
  const uint32_t direct = bytes_per_pixel(settings);
  settings.reuse = ReuseChoice::restir_gi;
  EXPECT_EQ(direct + bytes_per_pixel(settings), 580u);
}

}  // namespace
}  // namespace relume
