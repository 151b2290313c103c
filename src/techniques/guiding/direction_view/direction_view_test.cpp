// Values of the layers that show regions, known lights and directions.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "core/octahedral.h"
#include "files/testing/temp_folder.h"
#include "render/session.h"
#include "techniques/guiding/direction_view/direction_view_pass.h"
#include "techniques/light_sampling/visibility_light_cache/visibility_light_cache_pass.h"
#include "techniques/spatial/octree/octree_pass.h"

namespace relume {
namespace {

constexpr float kSide = 8;  // metres

/// A floor seen from above, below `lamps` quads of two lights each, or below a constant sky without lamps.
Scene floor_scene(int lamps) {
  SceneBuilder builder("floor");
  builder.add("floor", quad({-kSide / 2, 0, kSide / 2}, {kSide, 0, 0}, {0, 0, -kSide}),
              builder.add_material(matte("floor", Rgb(0.5f))));
  for (int i = 0; i < lamps; ++i) {
    const float x = 2 * static_cast<float>(i) - static_cast<float>(lamps - 1);
    builder.add("lamp", quad({x, 2, -4}, {0.5f, 0, 0}, {0, 0, 0.5f}), builder.add_material(emitter("lamp", Rgb(10))));
  }
  builder.add_camera({0, 5, 0.01f}, {0, 0, 0}, 60);
  Environment sky;
  if (lamps == 0) {
    sky.kind = EnvironmentKind::constant;
    sky.color = Rgb(2);
  }
  builder.set_environment(sky);
  return builder.take();
}

RenderSettings settings_of(int width, int height) {
  RenderSettings s;
  s.width = width;
  s.height = height;
  s.threads = 1;
  s.path.max_bounces = 1;
  s.history = HistoryChoice::none;
  s.octree.split = 64;
  s.octree.collapse = 32;
  s.octree.scale = false;
  return s;
}

void render(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) session.render_frame();
}

TEST(DirectionView, ShowsTheCosineBesideADensity) {
  constexpr int kEdge = 32;
  RenderSettings s = settings_of(2 * kEdge, kEdge);
  s.light_selection.environment = false;  // only paths sample it
  s.guide = GuideChoice::cdq;
  s.cdq.view = true;
  Session session(floor_scene(0), s);
  render(session, 32);
  const View<const float> shown = buffer_table(session).view(kDirections);
  double known = 0;
  double light = 0;
  for (int y = 0; y < kEdge; ++y) {
    for (int x = 0; x < kEdge; ++x) {
      const Vec3 w = direction_from_square(Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) /
                                           static_cast<float>(kEdge));
      const double texel = static_cast<double>(octahedral_solid_angle(w)) / (kEdge * kEdge);
      const size_t row = static_cast<size_t>(y) * 2 * kEdge;
      const auto left = static_cast<double>(shown[row + static_cast<size_t>(x)]);
      const auto right = static_cast<double>(shown[row + kEdge + static_cast<size_t>(x)]);
      known += left * texel;
      light += right * texel;
      // Directions differ by up to 0.1 within a texel; the mean of 32 frames reduces this to a sixth.
      const double cosine = std::max(0.0, static_cast<double>(w.y)) / 3.14159265358979;
      if (std::abs(w.y) > 0.1f) {
        EXPECT_NEAR(right, cosine, 0.02) << x << ' ' << y;
      }
      EXPECT_GT(left, 0) << x << ' ' << y;
    }
  }
  EXPECT_NEAR(known, 1, 1e-4);
  EXPECT_NEAR(light, 1, 1e-4);
}

TEST(DirectionView, IsEmptyOnceDisabled) {
  RenderSettings s = settings_of(32, 16);
  s.guide = GuideChoice::cdq;
  s.cdq.view = true;
  Session session(floor_scene(0), s);
  render(session, 2);
  const View<const float> shown = buffer_table(session).view(kDirections);
  const auto any = [&] { return std::any_of(shown.begin(), shown.end(), [](float v) { return v != 0.0f; }); };
  EXPECT_TRUE(any());
  s.cdq.view = false;
  session.set_settings(s);
  render(session, 1);
  EXPECT_FALSE(any());
}

TEST(DirectionView, ResumesFromCheckpoint) {
  RenderSettings s = settings_of(32, 16);
  s.light_selection.environment = false;  // only paths sample it
  s.guide = GuideChoice::cdq;
  s.cdq.view = true;
  const auto shown_by = [](const Session& session) {
    const View<const float> shown = buffer_table(session).view(kDirections);
    return std::vector<float>(shown.begin(), shown.end());
  };
  Session whole(floor_scene(0), s);
  render(whole, 3);
  const TempFolder folder;
  whole.save_checkpoint(folder / "c.ckpt");
  render(whole, 1);
  Session resumed(floor_scene(0), s);
  resumed.load_checkpoint(folder / "c.ckpt");
  render(resumed, 1);
  EXPECT_EQ(shown_by(resumed), shown_by(whole));
}

TEST(RegionView, LeafSizesMatchTheirDepth) {
  RenderSettings s = settings_of(48, 48);
  s.lights = LightSelectionChoice::vlc;
  Session session(floor_scene(3), s);
  render(session, 8);
  const View<const uint32_t> regions = buffer_table(session).view(kRegion);
  const View<const uint32_t> depths = buffer_table(session).view(kRegionDepth);
  const View<const Hit> hits = buffer_table(session).view(kPrimaryHits);
  std::map<uint32_t, std::pair<Vec2, Vec2>> boxes;
  std::map<uint32_t, uint32_t> depth_of;
  const float pixel = 2 * 5 * std::tan(glm::radians(30.0f)) / 48;  // width on the floor, metres
  for (uint32_t i = 0; i < regions.size; ++i) {
    ASSERT_TRUE(hits[i].valid());
    const Vec2 at = (Vec2(static_cast<float>(i % 48), static_cast<float>(i / 48)) - 23.5f) * pixel;
    EXPECT_EQ(depth_of.emplace(regions[i], depths[i]).first->second, depths[i]);
    auto& [low, high] = boxes.emplace(regions[i], std::pair(at, at)).first->second;
    low = glm::min(low, at);
    high = glm::max(high, at);
  }
  EXPECT_GT(boxes.size(), 16u);
  for (const auto& [region, box] : boxes) {
    const float edge = 1.001f * kSide / static_cast<float>(1u << depth_of[region]);
    EXPECT_LE(box.second.x - box.first.x, edge + pixel) << region;
    EXPECT_LE(box.second.y - box.first.y, edge + pixel) << region;
    EXPECT_GE(edge, pixel);
  }
}

TEST(KnownLightsView, CountsTheLightsOfTheRegion) {
  RenderSettings s = settings_of(48, 48);
  s.lights = LightSelectionChoice::vlc;
  Session session(floor_scene(3), s);
  render(session, 12);
  const View<const uint32_t> known = buffer_table(session).view(kKnownLights);
  uint32_t all = 0;
  for (const uint32_t count : known) {
    EXPECT_LE(count, 3u);
    all += count == 3 ? 1 : 0;
  }
  EXPECT_GT(all, known.size / 2);
  Session single(floor_scene(1), s);
  render(single, 4);
  for (const uint32_t count : buffer_table(single).view(kKnownLights)) EXPECT_LE(count, 1u);
}

}  // namespace
}  // namespace relume
