// Tests non-finite samples from the scene to the image: each is counted, treated as black, and isolated.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kSize = 8;
constexpr int kFrames = 4;

/// A card of 4 × 4 texels that fills the image. One texel is NaN, one infinite; the others are 0.5.
Scene broken_card(float environment) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  std::array<Vec4, 16> texels;
  texels.fill(Vec4(0.5f, 0.5f, 0.5f, 1));
  texels[5] = Vec4(0.5f, kNan, 0.5f, 1);
  texels[14] = Vec4(kInfinity, 0.5f, 0.5f, 1);
  Texture texture{
      .name = "broken", .width = 4, .height = 4, .format = PixelFormat::rgba32_float, .texels = {}, .file = {}};
  texture.filter = FilterMode::nearest;
  const auto* bytes = reinterpret_cast<const std::byte*>(texels.data());
  texture.texels.assign(bytes, bytes + sizeof texels);
  Scene scene;
  Material card = unlit(Rgb(1));
  card.base_color_texture.texture = add_texture(scene, texture);
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), card);
  if (environment > 0) set_constant_environment(scene, Rgb(environment));
  add_camera(scene, {.name = "", .projection = Projection::orthographic, .half_height = 1}, {0, 0, 1}, {0, 0, -1});
  return scene;
}

/// Each of the two texels covers four pixels.
bool is_broken(int x, int y) { return (x / 2 == 1 && y / 2 == 1) || (x / 2 == 2 && y / 2 == 3); }

TEST(Nonfinite, SamplesAreCountedAndBlack) {
  for (const HistoryChoice history : {HistoryChoice::none, HistoryChoice::accumulate, HistoryChoice::reproject}) {
    RenderSettings settings = small_settings(kSize, kSize);
    settings.history = history;
    Session session(broken_card(0), settings);
    for (int i = 1; i <= kFrames; ++i) {
      ASSERT_TRUE(session.render_frame());
      EXPECT_EQ(session.statistics().nonfinite_samples, 8u * static_cast<uint64_t>(i));
    }
    const Image image = session.image();
    for (int y = 0; y < kSize; ++y) {
      for (int x = 0; x < kSize; ++x) EXPECT_EQ(image.at(x, y), Rgb(is_broken(x, y) ? 0.0f : 0.5f)) << x << ", " << y;
    }
    EXPECT_TRUE(std::isfinite(session.estimated_error()) || history == HistoryChoice::none);
  }
}

TEST(Nonfinite, CountSurvivesChanges) {
  Session session(broken_card(0), small_settings(kSize, kSize));
  session.render_frame();
  session.set_material(0, unlit({1, 0, 0}));
  session.render_frame();
  EXPECT_EQ(session.statistics().nonfinite_samples, 8u);
  EXPECT_EQ(session.image().at(2, 2), Rgb(1, 0, 0));
}

TEST(Nonfinite, AdaptiveSamplingContinues) {
  RenderSettings settings = small_settings(kSize, kSize);
  settings.allocation = AllocationChoice::adaptive;
  Session session(broken_card(0), settings);
  for (int i = 0; i < 16; ++i) session.render_frame();
  EXPECT_GT(session.statistics().nonfinite_samples, 0u);
  for (const Rgb& pixel : session.image().pixels) EXPECT_TRUE(is_finite(pixel));
}

/// A sun with overflowing radiance on a card that covers the right half of the image.
TEST(Nonfinite, OverflowAlongThePathIsFound) {
  Scene scene;
  add(scene, quad({0, -1, 0}, {1, 0, 0}, {0, 2, 0}), matte("card", Rgb(0.5f)));
  add(scene, quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}), unlit(Rgb(0.25f)));
  add_light(scene,
            {.name = "", .type = PunctualType::directional, .intensity = Rgb(1e15f), .angular_diameter_rad = 1e-14f},
            {});
  add_camera(scene, {.name = "", .projection = Projection::orthographic, .half_height = 1}, {0, 0, 1}, {0, 0, -1});
  Session session(std::move(scene), small_settings(kSize, kSize));
  for (int i = 0; i < kFrames; ++i) session.render_frame();
  EXPECT_EQ(session.statistics().nonfinite_samples, uint64_t{kSize * kSize * kFrames / 2});
  for (const Rgb& pixel : session.image().pixels) EXPECT_TRUE(is_finite(pixel));
  EXPECT_EQ(session.image().at(0, 0), Rgb(0.25f));
}

}  // namespace
}  // namespace relume::support
