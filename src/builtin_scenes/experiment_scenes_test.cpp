// Properties of the scenes of single experiments.
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <glm/trigonometric.hpp>

#include "builtin_scenes/testing/scene_queries.h"

namespace relume {
namespace {

using testing::emissive_area;
using testing::emissive_count;
using testing::Hit;
using testing::scene_named;
using testing::spread;
using testing::trace;

size_t node_named(const Scene& scene, const std::string& name) {
  size_t i = 0;
  while (scene.nodes.at(i).name != name) ++i;
  return i;
}

/// Whether the quad of the node "lamp" shines on p, tested at five of its points.
bool is_lit(const Scene& scene, const Vec3& p) {
  const size_t lamp = node_named(scene, "lamp");
  const Mat4 world = world_matrices(scene, 0)[lamp];
  const std::vector<Vec3>& corners = scene.meshes[static_cast<size_t>(scene.nodes[lamp].meshes[0])].positions;
  for (const Vec2& uv : {Vec2(0.5f), Vec2(0.1f), Vec2(0.9f), Vec2(0.1f, 0.9f), Vec2(0.9f, 0.1f)}) {
    const Vec3 q = corners[0] + uv.x * (corners[1] - corners[0]) + uv.y * (corners[3] - corners[0]);
    const Hit hit = trace(scene, p, glm::normalize(transform_point(world, q) - p));
    if (hit.material && hit.front && !is_black(hit.material->emission)) return true;
  }
  return false;
}

/// The geometry is that of the mine, and only the sun's size differs.
TEST(MineSuns, HaveTheirDiameters) {
  const Scene& mine = scene_named("mine");
  EXPECT_FLOAT_EQ(mine.environment.sun_sky.sun_angular_diameter_rad, glm::radians(10.0f));
  const std::pair<const char*, float> suns[] = {{"mine-sun-5", 5}, {"mine-sun-2.5", 2.5f}, {"mine-sun-1", 1}};
  for (const auto& [name, degrees] : suns) {
    const Scene& scene = scene_named(name);
    EXPECT_FLOAT_EQ(scene.environment.sun_sky.sun_angular_diameter_rad, glm::radians(degrees)) << name;
    EXPECT_EQ(scene.environment.sun_sky.sun_scale, mine.environment.sun_sky.sun_scale) << name;
    EXPECT_EQ(scene.environment.sun_sky.sun_elevation_rad, mine.environment.sun_sky.sun_elevation_rad) << name;
    ASSERT_EQ(scene.meshes.size(), mine.meshes.size()) << name;
    for (size_t i = 0; i < mine.meshes.size(); ++i) EXPECT_EQ(scene.meshes[i].positions, mine.meshes[i].positions);
  }
}

TEST(WarehouseLayouts, HaveTheirLamps) {
  EXPECT_EQ(emissive_count(scene_named("warehouse-rooms")), 2u * 25 * 14);
  EXPECT_EQ(emissive_count(scene_named("warehouse-140")), 2u * 140 * 3);
  EXPECT_EQ(emissive_count(scene_named("warehouse-399")), 2u * 399);
}

/// Bays of 4.4 m have lamps of the same total power, however many.
TEST(WarehouseLayouts, BaysHaveTheSamePower) {
  const float three = emissive_area(scene_named("warehouse-140")) / 140;
  EXPECT_NEAR(emissive_area(scene_named("warehouse-399")) / 399, three, 1e-3f * three);  // sums of floats
}

/// Seen from the floor, what the lamp lights covers at most 1 % of the sphere of directions.
TEST(TurntableSpot, LitPatchIsSmall) {
  const Scene& scene = scene_named("turntable-spot");
  constexpr int kRays = 4000;
  // Not the middle, from which a peg hides the patch.
  for (const Vec3& eye : {Vec3(0, 0.01f, 0.5f), Vec3(1.9f, 0.01f, 0), Vec3(0, 0.01f, 1.9f)}) {
    int lit = 0;
    for (int i = 0; i < kRays; ++i) {
      const Vec3 w = spread(i, kRays);
      if (w.y <= 0) continue;  // into the floor
      const Hit hit = trace(scene, eye, w);
      if (hit.material && is_lit(scene, eye + 0.999f * hit.distance * w)) ++lit;
    }
    EXPECT_GT(lit, 0) << eye.x << ", " << eye.z;
    EXPECT_LE(lit, kRays / 100) << eye.x << ", " << eye.z;
  }
}

/// The floor itself is not lit, and the camera does not see the lamp.
TEST(TurntableSpot, LampIsHidden) {
  const Scene& scene = scene_named("turntable-spot");
  for (int i = 0; i < 100; ++i) {
    const float radius = 0.02f * static_cast<float>(i);
    const float angle = static_cast<float>(i);
    EXPECT_FALSE(is_lit(scene, {radius * std::cos(angle), 0.01f, radius * std::sin(angle)})) << i;
  }
  EXPECT_FALSE(is_lit(scene, {0, 6.2f, 4.0f}));
}

struct SquareHole {
  Vec2 middle;  ///< x, z
  float size;
};
constexpr float kCeiling = 3.5f;
const SquareHole kHoles[] = {{{2, 4}, 0.3f}, {{5, 2.5f}, 1}, {{9, 3.5f}, 2}};

TEST(Skylight, HolesHaveTheirSizes) {
  const Scene& scene = scene_named("skylight");
  EXPECT_FLOAT_EQ(scene.environment.sun_sky.sun_angular_diameter_rad, glm::radians(1.0f));
  const Vec3 up(0, 1, 0);
  for (const SquareHole& hole : kHoles) {
    for (const Vec2& side : {Vec2(1, 0), Vec2(-1, 0), Vec2(0, 1), Vec2(0, -1)}) {
      const Vec2 inside = hole.middle + 0.49f * hole.size * side;
      const Vec2 outside = hole.middle + 0.51f * hole.size * side;
      EXPECT_FALSE(trace(scene, {inside.x, 3, inside.y}, up).material) << hole.size;
      EXPECT_TRUE(trace(scene, {outside.x, 3, outside.y}, up).material) << hole.size;
    }
  }
}

/// Rays leave the room through the holes only, and meet fronts otherwise.
TEST(Skylight, IsClosedExceptForItsHoles) {
  const Scene& scene = scene_named("skylight");
  constexpr int kRays = 3000;
  int escaped = 0;
  for (const Vec3& eye : {Vec3(0.6f, 1.6f, 6.4f), Vec3(9, 1, 3.4f), Vec3(11.9f, 3.4f, 0.1f)}) {
    for (int i = 0; i < kRays; ++i) {
      const Vec3 w = spread(i, kRays);
      const Hit hit = trace(scene, eye, w);
      if (hit.material) {
        ASSERT_TRUE(hit.front) << hit.material->name;
        continue;
      }
      ++escaped;
      ASSERT_GT(w.y, 0);
      const Vec3 p = eye + (kCeiling - eye.y) / w.y * w;
      bool through_hole = false;
      for (const SquareHole& hole : kHoles) {
        const Vec2 offset = glm::abs(Vec2(p.x, p.z) - hole.middle);
        through_hole = through_hole || std::fmax(offset.x, offset.y) <= 0.501f * hole.size;
      }
      ASSERT_TRUE(through_hole) << p.x << ", " << p.z;
    }
  }
  EXPECT_GT(escaped, 100);
}

}  // namespace
}  // namespace relume
