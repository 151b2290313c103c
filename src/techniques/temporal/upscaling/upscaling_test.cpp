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

/// A denoised view, beside the same without earlier denoised images.
struct DenoisedView {
  explicit DenoisedView(int n, const char* scene = "cornell-spheres")
      : blended(find_builtin_scene(scene)->build(), settings_of(n, 0.2f)),
        alone(find_builtin_scene(scene)->build(), settings_of(n, 1.0f)) {}

  static RenderSettings settings_of(int n, float newest) {
    RenderSettings settings = small_image();
    settings.denoise = DenoiseChoice::svgf;
    settings.svgf.history.newest = newest;
    settings.upscaling.factor = n;
    return settings;
  }
  void render_frame() {
    blended.render_frame();
    alone.render_frame();
  }
  void look(const CameraPose& camera) {
    blended.set_camera(camera);
    alone.set_camera(camera);
    render_frame();
  }
  /// Share of the pixels that earlier images change.
  double blended_share() const {
    const std::vector<Rgb> a = blended.image().pixels;
    const std::vector<Rgb> b = alone.image().pixels;
    int different = 0;
    for (size_t i = 0; i < a.size(); ++i) different += a[i] != b[i] ? 1 : 0;
    return static_cast<double>(different) / static_cast<double>(a.size());
  }

  Session blended;
  Session alone;
};

TEST(Upscaling, MovingViewsKeepTheirDenoisedImages) {
  for (const int n : {1, 2}) {
    DenoisedView view(n);
    CameraPose camera = view.blended.camera();
    for (int i = 0; i < 8; ++i) {
      camera.to_world[3] += 0.002f * camera.to_world[0];
      view.look(camera);
    }
    EXPECT_GT(view.blended_share(), 0.5) << n;
    // A cut: into the room, towards a wall.
    camera.to_world[3] -= 2.0f * camera.to_world[2];
    std::swap(camera.to_world[0], camera.to_world[2]);
    camera.to_world[0] *= -1.0f;
    view.look(camera);
    EXPECT_EQ(view.blended_share(), 0.0) << n;
  }
}

TEST(Upscaling, ViewsAtRestAverageImagesInWhichAllPixelsHaveSamples) {
  DenoisedView view(2, "cornell-closed");
  for (int frame = 1; frame <= 5; ++frame) {
    view.render_frame();
    const double share = view.blended_share();
    EXPECT_TRUE(frame == 1 || frame == 4 ? share < 0.1 : share > 0.5) << frame << ": " << share;
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
