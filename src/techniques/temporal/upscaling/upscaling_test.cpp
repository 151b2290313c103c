#include "techniques/temporal/upscaling/upscaling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/temporal/upscaling/settings.h"

namespace relume {
namespace {

constexpr uint32_t kMost = kMostUpscale;

TEST(Upscaling, EveryPixelOfABlockGetsATurn) {
  for (uint32_t n = 1; n <= kMost; ++n) {
    std::set<std::pair<uint32_t, uint32_t>> seen;
    for (uint32_t turn = 0; turn < n * n; ++turn) {
      const BlockPosition p = block_position(n, 7 * n * n + turn);
      EXPECT_LT(p.x, n);
      EXPECT_LT(p.y, n);
      seen.emplace(p.x, p.y);
    }
    EXPECT_EQ(seen.size(), n * n) << n;
  }
}

TEST(Upscaling, TurnsFormAnEvenGridAsEarlyAsPossible) {
  // The first four turns of 4 × 4 lie in different quarters, and those of 2 × 2 begin with a diagonal.
  std::set<std::pair<uint32_t, uint32_t>> quarters;
  for (uint32_t turn = 0; turn < 4; ++turn) {
    const BlockPosition p = block_position(4, turn);
    quarters.emplace(p.x / 2, p.y / 2);
    EXPECT_EQ(p.x % 2 + p.y % 2, 0u);
  }
  EXPECT_EQ(quarters.size(), 4u);
  for (uint32_t n = 2; n <= kMost; ++n) {
    const BlockPosition a = block_position(n, 0);
    const BlockPosition b = block_position(n, 1);
    EXPECT_NE(a.x, b.x) << n;
    EXPECT_NE(a.y, b.y) << n;
  }
}

TEST(Upscaling, FillsPixelsFromThoseAroundThem) {
  const std::vector<Rgb> mean{Rgb(1), Rgb(0), Rgb(3), Rgb(0), Rgb(0), Rgb(8)};
  const std::vector<uint32_t> samples{1, 0, 1, 0, 0, 1};
  std::vector<Rgb> filled(mean.size());
  const FillUnsampledKernel kernel{view_of(mean), view_of(samples), mutable_view_of(filled), 3, 6, 1};
  for (uint32_t x = 0; x < 6; ++x) kernel(x, 0);
  for (const size_t i : {0u, 2u, 5u}) EXPECT_EQ(filled[i], mean[i]);
  EXPECT_FLOAT_EQ(filled[1].g, 2.0f);
  EXPECT_FLOAT_EQ(filled[3].g, (3.0f + 8.0f / 4) / (1.0f + 1.0f / 4));
  EXPECT_FLOAT_EQ(filled[4].g, (3.0f / 4 + 8.0f) / (1.0f / 4 + 1.0f));
}

RenderSettings small_image() {
  RenderSettings settings;
  settings.width = 50;
  settings.height = 37;
  return settings;
}

Image after(const RenderSettings& settings, uint32_t frames) {
  Session session(find_builtin_scene("cornell-spheres")->build(), settings);
  for (uint32_t i = 0; i < frames; ++i) session.render_frame();
  return session.image();
}

TEST(Upscaling, AllTurnsGiveTheImageOfOneFullFrame) {
  const Image full = after(small_image(), 1);
  for (uint32_t n = 2; n <= kMost; ++n) {
    RenderSettings settings = small_image();
    settings.upscaling.factor = static_cast<int>(n);
    EXPECT_EQ(after(settings, n * n).pixels, full.pixels) << n;
  }
}

TEST(Upscaling, TracesOnePathPerBlock) {
  RenderSettings settings = small_image();
  settings.width = settings.height = 48;
  settings.upscaling.factor = 4;
  Session session(find_builtin_scene("cornell")->build(), settings);
  session.render_frame();
  EXPECT_EQ(session.statistics().paths, 144u);
}

TEST(Upscaling, NoPixelOfTheFirstFrameIsEmpty) {
  for (const DenoiseChoice denoise : {DenoiseChoice::none, DenoiseChoice::svgf, DenoiseChoice::bmfr}) {
    for (const int n : {2, 3, 4}) {
      for (const int width : {50, 3, 2}) {
        RenderSettings settings = small_image();
        settings.width = width;
        settings.height = std::min(width, 37);
        settings.upscaling.factor = n;
        settings.denoise = denoise;
        Session session(testing::closed_furnace(0.5f), settings);
        session.render_frame();
        for (const Rgb& pixel : session.image().pixels)
          ASSERT_GT(min_component(pixel), 0.0f) << static_cast<int>(denoise) << ' ' << n << ' ' << width;
      }
    }
  }
}

/// Share of the values in which the average over frames differs from the last frame's denoised image.
double blended_share(const Session& session) {
  const std::vector<float> shown = session.aov("svgf-shown").front().values;
  const std::vector<float> image = session.aov("svgf-image").front().values;
  int different = 0;
  for (size_t i = 0; i < shown.size(); ++i) different += shown[i] != image[i] ? 1 : 0;
  return static_cast<double>(different) / static_cast<double>(shown.size());
}

void step_sideways(Session& session, float metres) {
  CameraPose camera = session.camera();
  camera.to_world[3] += metres * camera.to_world[0];
  session.set_camera(camera);
  session.render_frame();
}

TEST(Upscaling, MovingViewsKeepTheirDenoisedImages) {
  for (const int n : {1, 2}) {
    RenderSettings settings = small_image();
    settings.denoise = DenoiseChoice::svgf;
    settings.upscaling.factor = n;
    Session session(find_builtin_scene("cornell-spheres")->build(), settings);
    for (int i = 0; i < 8; ++i) step_sideways(session, 0.002f);
    EXPECT_GT(blended_share(session), 0.5) << n;
    CameraPose elsewhere = session.camera();  // a cut: into the room, towards a wall
    elsewhere.to_world[3] -= 2.0f * elsewhere.to_world[2];
    std::swap(elsewhere.to_world[0], elsewhere.to_world[2]);
    elsewhere.to_world[0] *= -1.0f;
    session.set_camera(elsewhere);
    session.render_frame();
    EXPECT_LT(blended_share(session), 0.01) << n;
  }
}

TEST(Upscaling, ViewsAtRestAverageImagesInWhichAllPixelsHaveSamples) {
  RenderSettings settings = small_image();
  settings.denoise = DenoiseChoice::svgf;
  settings.upscaling.factor = 2;
  Session session(find_builtin_scene("cornell-closed")->build(), settings);
  for (int frame = 1; frame <= 5; ++frame) {
    session.render_frame();
    if (frame == 1 || frame == 4) EXPECT_LT(blended_share(session), 0.1) << frame;
    if (frame == 3 || frame == 5) EXPECT_GT(blended_share(session), 0.5) << frame;
  }
}

TEST(Upscaling, ViewsMaySwitchItWithoutLosingTheirHistory) {
  RenderSettings settings = small_image();
  settings.denoise = DenoiseChoice::svgf;
  settings.switches_upscaling = true;
  settings.upscaling.factor = 2;
  Session session(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  settings.upscaling.factor = 1;
  ASSERT_TRUE(session.set_settings(settings));
  session.render_frame();
  EXPECT_EQ(session.frames_since_change(), 5u);
  EXPECT_EQ(session.statistics().paths, 2u * 50 * 37);
}

TEST(Upscaling, ViewsThatDoNotUseItHaveTheBitsOfOthers) {
  RenderSettings settings = small_image();
  settings.denoise = DenoiseChoice::svgf;
  settings.lights = LightSelectionChoice::vlc;  // learns, and renders epochs of several frames
  const Image without = after(settings, 9);
  settings.switches_upscaling = true;
  EXPECT_EQ(after(settings, 9).pixels, without.pixels);
}

TEST(Upscaling, RefusesOtherChoicesOfPixels) {
  RenderSettings settings;
  settings.upscaling.factor = 2;
  EXPECT_NO_THROW(check_combination(settings));
  settings.history = HistoryChoice::none;
  EXPECT_THROW(check_combination(settings), Error);
  settings.history = HistoryChoice::accumulate;
  settings.allocation = AllocationChoice::adaptive;
  EXPECT_THROW(check_combination(settings), Error);
  settings.allocation = AllocationChoice::uniform;
  settings.crop = {0, 0, 4, 4};
  EXPECT_THROW(check_combination(settings), Error);
}

}  // namespace
}  // namespace relume
