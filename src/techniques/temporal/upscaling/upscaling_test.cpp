#include "techniques/temporal/upscaling/upscaling.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
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

/// A row of pixels, of which every second one has a sample.
struct Row {
  std::vector<Rgb> mean{Rgb(1), Rgb(0), Rgb(3), Rgb(0), Rgb(8)};
  std::vector<uint32_t> samples{1, 0, 1, 0, 1};
  std::vector<Rgb> albedo = std::vector<Rgb>(5, Rgb(0.5f));
  std::vector<Vec3> normal = std::vector<Vec3>(5, Vec3(0, 0, 1));
  std::vector<uint32_t> surface{4, 4, 4, 9, 9};

  std::vector<Rgb> filled() const {
    std::vector<Rgb> result(mean.size());
    const FillUnsampledKernel kernel{view_of(mean),
                                     view_of(samples),
                                     view_of(albedo),
                                     view_of(normal),
                                     view_of(surface),
                                     mutable_view_of(result),
                                     2,
                                     5,
                                     1};
    for (uint32_t x = 0; x < 5; ++x) kernel(x, 0);
    return result;
  }
};

TEST(Upscaling, KeepsSampledPixels) {
  const Row row;
  const std::vector<Rgb> filled = row.filled();
  for (const size_t i : {0u, 2u, 4u}) EXPECT_EQ(filled[i], row.mean[i]);
}

TEST(Upscaling, FillsFromTheSameSurface) {
  const std::vector<Rgb> filled = Row().filled();
  EXPECT_NEAR(filled[1].g, 2.0f, 1e-6f);  // mean of 1 and 3
  EXPECT_NEAR(filled[3].g, 8.0f, 1e-2f);  // 3 belongs to another surface
}

TEST(Upscaling, FillsFromOtherSurfacesIfThereIsNoOther) {
  Row row;
  row.surface[3] = 77;
  EXPECT_NEAR(row.filled()[3].g, 5.5f, 1e-5f);
}

TEST(Upscaling, FollowsTheTextureWhereItFills) {
  Row row;
  row.albedo[1] = Rgb(0.25f);
  // From two pixels of twice the albedo.
  EXPECT_NEAR(row.filled()[1].g, 2.0f * 0.26f / 0.51f, 1e-5f);
}

TEST(Upscaling, FollowsTheNormalWhereItFills) {
  Row row;
  row.normal[2] = Vec3(1, 0, 0);
  EXPECT_NEAR(row.filled()[1].g, 1.0f, 1e-3f);
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
    RenderSettings settings = small_image();
    settings.upscaling.factor = 2;
    settings.denoise = denoise;
    Session session(find_builtin_scene("furnace")->build(), settings);
    session.render_frame();
    for (const Rgb& pixel : session.image().pixels) {
      ASSERT_GT(min_component(pixel), 0.0f) << static_cast<int>(denoise);
    }
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
