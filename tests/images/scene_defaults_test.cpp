// Tests the replacement of missing lights and cameras, and the session's notes on it.
#include <gtest/gtest.h>

#include <utility>

#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kSize = 24;

Scene ball(EnvironmentKind light, bool camera) {
  Scene scene;
  add(scene, icosphere(2, 3), matte("ball", Rgb(0.4f)));
  scene.environment.kind = light;
  if (camera) add_camera(scene, {.name = "front", .fov_y_rad = 0.8f}, {0, 0, 8}, {0, 0, -1});
  return scene;
}

struct Rendered {
  Image image;
  std::vector<std::string> notes;
};

Rendered render_small(Scene scene) {
  RenderSettings settings = small_settings(kSize, kSize);
  Session session(std::move(scene), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  return {session.image(), session.notes()};
}

TEST(SceneDefaults, NoNoteIfNothingIsMissing) {
  EXPECT_TRUE(render_small(ball(EnvironmentKind::constant, true)).notes.empty());
}

TEST(SceneDefaults, LightIsTheStudio) {
  const Rendered automatic = render_small(ball(EnvironmentKind::automatic, true));
  ASSERT_EQ(automatic.notes.size(), 1u);
  EXPECT_NE(automatic.notes[0].find("no light"), std::string::npos) << automatic.notes[0];
  EXPECT_EQ(automatic.image.pixels, render_small(ball(EnvironmentKind::studio, true)).image.pixels);
  const Rgb middle = automatic.image.at(kSize / 2, kSize / 2);
  const Rgb corner = automatic.image.at(0, 0);
  EXPECT_GT(luminance(middle), 1.2f * luminance(corner)) << "the ball is brighter than the backdrop";
  EXPECT_GT(luminance(corner), 0.05f);
}

TEST(SceneDefaults, TheStudioTurnsWithTheCamera) {
  Scene turned = ball(EnvironmentKind::studio, false);
  add_camera(turned, {.name = "side", .fov_y_rad = 0.8f}, {8, 0, 0}, {-1, 0, 0});
  const Estimate side = estimate_of(render_small(std::move(turned)).image);
  const Estimate front = estimate_of(render_small(ball(EnvironmentKind::studio, true)).image);
  EXPECT_NEAR(luminance(side.mean), luminance(front.mean), 0.03f * luminance(front.mean));
}

TEST(SceneDefaults, CameraFramesTheScene) {
  const Rendered without = render_small(ball(EnvironmentKind::constant, false));
  ASSERT_EQ(without.notes.size(), 1u);
  EXPECT_NE(without.notes[0].find("no camera"), std::string::npos) << without.notes[0];
  IVec2 low(kSize);
  IVec2 high(0);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      if (without.image.at(x, y).r > 0.9f) continue;
      low = glm::min(low, IVec2(x, y));
      high = glm::max(high, IVec2(x, y));
    }
  }
  const IVec2 size = high - low + 1;
  EXPECT_NEAR(size.x, 0.88f * kSize, 1.5f);
  EXPECT_NEAR(size.y, 0.88f * kSize, 1.5f);
}

TEST(SceneDefaults, NotesBothDefaults) {
  EXPECT_EQ(render_small(ball(EnvironmentKind::automatic, false)).notes.size(), 2u);
}

TEST(SceneDefaults, UnlitSurfacesNeedNoLight) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), unlit({0.5f, 0.25f, 0.125f}));
  add_spot_meter(scene, Vec3(0), {0, 0, -1}, 1);
  EXPECT_TRUE(render_small(std::move(scene)).notes.empty());
}

}  // namespace
}  // namespace relume::support
