// Files without a light or a camera: what stands in, and that the session says so.
#include <gtest/gtest.h>

#include <utility>

#include "render/session.h"
#include "support/measure.h"
#include "support/scenes.h"

namespace relume::support {
namespace {

constexpr int kSize = 24;

Scene ball(bool light, bool camera) {
  Scene scene;
  add(scene, icosphere(2, 3), matte("ball", Rgb(0.4f)));
  if (light) set_constant_environment(scene, Rgb(1));
  if (camera) add_camera(scene, {.name = "front", .fov_y_rad = 0.8f}, {0, 0, 8}, {0, 0, -1});
  return scene;
}

struct Shown {
  Image image;
  std::vector<std::string> notes;
};

Shown show(Scene scene) {
  RenderSettings settings = small_settings(kSize, kSize);
  Session session(std::move(scene), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  return {session.image(), session.notes()};
}

TEST(StandIn, NothingIsSaidWhereNothingIsMissing) { EXPECT_TRUE(show(ball(true, true)).notes.empty()); }

TEST(StandIn, LightIsAnEnvironmentOfRadianceOne) {
  const Shown without = show(ball(false, true));
  ASSERT_EQ(without.notes.size(), 1u);
  EXPECT_NE(without.notes[0].find("no light"), std::string::npos) << without.notes[0];
  EXPECT_EQ(without.image.pixels, show(ball(true, true)).image.pixels);
}

TEST(StandIn, CameraSeesTheWholeScene) {
  const Shown without = show(ball(true, false));
  ASSERT_EQ(without.notes.size(), 1u);
  EXPECT_NE(without.notes[0].find("no camera"), std::string::npos) << without.notes[0];
  int covered = 0;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const bool on_ball = without.image.at(x, y).r < 0.9f;
      covered += on_ball ? 1 : 0;
      const bool at_border = x % (kSize - 1) == 0 || y % (kSize - 1) == 0;
      EXPECT_FALSE(at_border && on_ball) << "cut off at " << x << ", " << y;
    }
  }
  EXPECT_GT(covered, kSize * kSize / 5);
}

TEST(StandIn, BothAreSaid) { EXPECT_EQ(show(ball(false, false)).notes.size(), 2u); }

TEST(StandIn, UnlitSurfacesNeedNoLight) {
  Scene scene;
  add(scene, quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), unlit({0.5f, 0.25f, 0.125f}));
  add_spot_meter(scene, Vec3(0), {0, 0, -1}, 1);
  EXPECT_TRUE(show(std::move(scene)).notes.empty());
}

}  // namespace
}  // namespace relume::support
