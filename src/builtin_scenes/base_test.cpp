// Properties of the ten bases, and of their plans.
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/base_plan.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/testing/scene_queries.h"
#include "core/hash.h"
#include "scene/scene_hash.h"

namespace relume {
namespace {

using testing::camera_node;
using testing::emissive_count;
using testing::Hit;
using testing::scene_named;
using testing::spread;
using testing::trace;

constexpr uint32_t kSeeds = 10;
constexpr float kHeight = 3.2f;
constexpr float kWall = 0.1f;  // half of the walls' thickness
constexpr float kHole = 1.5f;

const Scene& base(uint32_t seed) { return scene_named("base-" + std::to_string(seed)); }

float random(uint32_t i, uint32_t what) { return to_unit_float(hash(i, what, 77u)); }

Vec2 point_in(const BaseRoom& room, uint32_t i) {
  return room.low + Vec2(random(i, 0), random(i, 1)) * (room.high - room.low);
}

TEST(Base, SeedsDecide) {
  std::set<uint64_t> hashes;
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) hashes.insert(scene_hash(base(seed)));
  EXPECT_EQ(hashes.size(), kSeeds);
  EXPECT_EQ(scene_hash(build_base(3)), scene_hash(base(3)));
}

TEST(Base, CountsAreAsPromised) {
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const BasePlan plan = make_base_plan(seed);
    EXPECT_GE(plan.rooms.size(), 40u) << seed;
    EXPECT_LE(plan.rooms.size(), 60u) << seed;
    EXPECT_GE(emissive_count(base(seed)), 800u) << seed;
    EXPECT_LE(emissive_count(base(seed)), 2000u) << seed;
    EXPECT_GE(plan.walk.size(), 5u) << seed;
    EXPECT_EQ(base(seed).visible_sets.size(), plan.rooms.size()) << seed;
    const auto skylights = std::count_if(plan.rooms.begin(), plan.rooms.end(),
                                         [](const BaseRoom& room) { return room.lamps == BaseLamps::skylight; });
    EXPECT_EQ(skylights, 1) << seed;
  }
}

TEST(Base, RoomsCoverThePlanAndAreConnected) {
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const BasePlan plan = make_base_plan(seed);
    float area = 0;
    for (const BaseRoom& room : plan.rooms) {
      const Vec2 size = room.high - room.low;
      EXPECT_GE(std::fmin(size.x, size.y), 3.0f);
      area += size.x * size.y;
    }
    EXPECT_EQ(area, BasePlan::kWidth * BasePlan::kDepth);  // whole numbers
    std::vector<bool> reached(plan.rooms.size(), false);
    std::vector<uint32_t> open{0};
    reached[0] = true;
    while (!open.empty()) {
      const uint32_t room = open.back();
      open.pop_back();
      for (const Portal& portal : plan.portals()) {
        for (int side = 0; side < 2; ++side) {
          if (portal.rooms[side] != room || reached[portal.rooms[1 - side]]) continue;
          reached[portal.rooms[1 - side]] = true;
          open.push_back(portal.rooms[1 - side]);
        }
      }
    }
    EXPECT_EQ(std::count(reached.begin(), reached.end(), false), 0) << seed;
  }
}

TEST(Base, LampsAreInsideRooms) {
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const BasePlan plan = make_base_plan(seed);
    for (const Mesh& mesh : base(seed).meshes) {
      if (is_black(base(seed).materials[static_cast<size_t>(mesh.material)].emission)) continue;
      for (const UVec3& t : mesh.triangles) {
        const auto has_all = [&](const BaseRoom& room) {
          bool inside = true;
          for (const uint32_t v : {t.x, t.y, t.z}) {
            const Vec3& p = mesh.positions[v];
            inside = inside && p.x > room.low.x + kWall && p.x < room.high.x - kWall && p.z > room.low.y + kWall &&
                     p.z < room.high.y - kWall && p.y > 0 && p.y < kHeight;
          }
          return inside;
        };
        ASSERT_EQ(std::count_if(plan.rooms.begin(), plan.rooms.end(), has_all), 1) << seed << ", " << mesh.name;
      }
    }
  }
}

/// Rays leave through the skylight only, also where doors are open.
TEST(Base, IsClosedExceptForItsSkylight) {
  const BasePlan plan = make_base_plan(1);
  const Scene& scene = base(1);
  constexpr int kRays = 60;
  int escaped = 0;
  for (const BaseRoom& room : plan.rooms) {
    const bool has_sky = room.lamps == BaseLamps::skylight;
    const Vec3 eye(room.middle().x, 1.1f, room.middle().y);
    for (int i = 0; i < (has_sky ? 10 * kRays : kRays); ++i) {
      const Vec3 w = spread(i, has_sky ? 10 * kRays : kRays);
      const Hit hit = trace(scene, eye, w, 5);
      if (hit.material) {
        ASSERT_TRUE(hit.front) << hit.material->name;
        continue;
      }
      ++escaped;
      ASSERT_GT(w.y, 0);
      const Vec3 p = eye + (kHeight - eye.y) / w.y * w;
      const auto through_hole = [&](const BaseRoom& r) {
        const Vec2 offset = glm::abs(Vec2(p.x, p.z) - r.middle());
        return r.lamps == BaseLamps::skylight && std::fmax(offset.x, offset.y) <= 0.501f * kHole;
      };
      ASSERT_TRUE(std::any_of(plan.rooms.begin(), plan.rooms.end(), through_hole)) << p.x << ", " << p.z;
    }
  }
  EXPECT_GT(escaped, 10);
}

TEST(Base, DoorsSinkAndRise) {
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const BasePlan plan = make_base_plan(seed);
    const Scene& scene = base(seed);
    int leaves = 0;
    for (size_t node = 0; node < scene.nodes.size(); ++node) {
      const std::string& name = scene.nodes[node].name;
      if (!name.starts_with("door ")) continue;
      ++leaves;
      const BaseDoor& door = plan.doors.at(std::stoul(name.substr(5)));
      const auto height = [&](float time_s) { return world_matrices(scene, time_s)[node][3].y; };
      EXPECT_EQ(height(0), 0.0f);
      EXPECT_EQ(height(door.opens_s), 0.0f);
      EXPECT_LT(height(door.opens_s + 1), -2.2f);
      EXPECT_LT(height(door.closes_s), -2.2f);
      EXPECT_EQ(height(door.closes_s + 1.01f), 0.0f);
    }
    EXPECT_GT(leaves, 10) << seed;
  }
}

/// Nothing is within 0.2 m of the eye, not even a door.
TEST(Base, WalkStaysInFreeSpace) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const BasePlan plan = make_base_plan(seed);
    const Scene& scene = base(seed);
    const float end_s = BasePlan::kWait_s + BasePlan::kStep_s * static_cast<float>(plan.walk_doors.size());
    std::set<uint32_t> visited;
    for (float time_s = 0; time_s <= end_s; time_s += 0.15f) {
      const Vec3 eye(world_matrices(scene, time_s)[camera_node(scene)][3]);
      for (int i = 0; i < 14; ++i)
        ASSERT_GT(trace(scene, eye, spread(i, 14), time_s).distance, 0.2f) << seed << ", " << time_s << " s";
      for (uint32_t r = 0; r < plan.rooms.size(); ++r) {
        const BaseRoom& room = plan.rooms[r];
        if (eye.x > room.low.x && eye.x < room.high.x && eye.z > room.low.y && eye.z < room.high.y) visited.insert(r);
      }
    }
    EXPECT_EQ(visited, std::set<uint32_t>(plan.walk.begin(), plan.walk.end())) << seed;
  }
}

TEST(Base, LampsFlicker) {
  for (uint32_t seed = 1; seed <= kSeeds; ++seed) {
    const Scene& scene = base(seed);
    ASSERT_EQ(scene.parameter_animation.size(), 1u) << seed;
    const ParameterChannel& channel = scene.parameter_animation.front();
    const Material& material = scene.materials[static_cast<size_t>(channel.index)];
    EXPECT_EQ(Rgb(channel.values.front()), material.emission);
    std::set<float> levels;
    for (const Vec4& value : channel.values) levels.insert(value.x / material.emission.x);
    EXPECT_EQ(levels.size(), 2u);
    EXPECT_GT(*levels.begin(), 0.1f);
  }
}

/// Whether the segment from p to q crosses walls only where they have doors.
bool is_free(const BasePlan& plan, const Vec2& p, const Vec2& q) {
  for (const BaseWall& wall : plan.walls) {
    const int across = wall.along_x() ? 1 : 0;
    const float from = p[across] - wall.a[across];
    const float to = q[across] - wall.a[across];
    if (from * to >= 0) continue;
    const float at = lerp(p[1 - across], q[1 - across], from / (from - to));
    if (at < wall.a[1 - across] || at > wall.b[1 - across]) continue;
    if (wall.door < 0) return false;
    const float middle = plan.doors[static_cast<size_t>(wall.door)].middle()[1 - across];
    if (std::fabs(at - middle) > BasePlan::kDoorWidth / 2) return false;
  }
  return true;
}

/// Rooms that a free segment connects see each other.
TEST(BaseVisibility, HoldsAllRoomsThatSegmentsConnect) {
  for (const uint32_t seed : {1u, 2u, 3u}) {
    const BasePlan plan = make_base_plan(seed);
    const auto count = static_cast<uint32_t>(plan.rooms.size());
    const auto visible = visible_rooms(count, plan.portals());
    int connected = 0;
    for (uint32_t i = 0; i < 200'000; ++i) {
      const uint32_t a = hash(seed, i, 1u) % count;
      const uint32_t b = hash(seed, i, 2u) % count;
      if (a == b || !is_free(plan, point_in(plan.rooms[a], 2 * i), point_in(plan.rooms[b], 2 * i + 1))) continue;
      ++connected;
      ASSERT_TRUE(std::binary_search(visible[a].begin(), visible[a].end(), b)) << seed << ": " << a << ", " << b;
    }
    EXPECT_GT(connected, 100) << seed;
  }
}

/// Nearly all rooms that see each other are connected by segments from a door of one to a door of the other. Random
/// segments miss narrow gaps.
TEST(BaseVisibility, HoldsFewOtherRooms) {
  const BasePlan plan = make_base_plan(1);
  const auto visible = visible_rooms(static_cast<uint32_t>(plan.rooms.size()), plan.portals());
  const auto on_door_of = [&](uint32_t room, uint32_t i) {
    std::vector<const BaseDoor*> doors;
    for (const BaseDoor& door : plan.doors) {
      if (door.portal.rooms[0] == room || door.portal.rooms[1] == room) doors.push_back(&door);
    }
    const BaseDoor& door = *doors[hash(i, room, 5u) % doors.size()];
    return door.portal.left + random(i, room) * (door.portal.right - door.portal.left);
  };
  int listed = 0;
  int connected = 0;
  for (uint32_t a = 0; a < visible.size(); ++a) {
    EXPECT_TRUE(std::binary_search(visible[a].begin(), visible[a].end(), a));
    EXPECT_LT(visible[a].size(), plan.rooms.size());
    for (const uint32_t b : visible[a]) {
      EXPECT_TRUE(std::binary_search(visible[b].begin(), visible[b].end(), a)) << a << ", " << b;
      if (a == b) continue;
      ++listed;
      bool found = false;
      for (uint32_t i = 0; i < 2000 && !found; ++i)
        found = is_free(plan, on_door_of(a, 2 * i), on_door_of(b, 2 * i + 1));
      connected += found ? 1 : 0;
    }
  }
  EXPECT_GT(connected, 0.85 * listed);
}

/// A closed door hides more.
TEST(BaseVisibility, ClosedDoorsHide) {
  const BasePlan plan = make_base_plan(1);
  const auto count = static_cast<uint32_t>(plan.rooms.size());
  std::vector<Portal> open;
  for (const BaseDoor& door : plan.doors) {
    if (!door.has_leaf) open.push_back(door.portal);
  }
  const auto fewer = visible_rooms(count, open);
  const auto all = visible_rooms(count, plan.portals());
  size_t hidden = 0;
  for (uint32_t room = 0; room < count; ++room) {
    EXPECT_TRUE(std::includes(all[room].begin(), all[room].end(), fewer[room].begin(), fewer[room].end()));
    hidden += all[room].size() - fewer[room].size();
  }
  EXPECT_GT(hidden, 0u);
}

}  // namespace
}  // namespace relume
