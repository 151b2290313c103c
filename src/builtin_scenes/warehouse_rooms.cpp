// Five by five storage rooms of 9 m with 350 lamps. From any place only the lamps of one room, and a few through
// openings, are visible. Lamps behind the walls are far away, so that a light tree does well without visibility.
#include <string>
#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"
#include "builtin_scenes/shelves.h"
#include "core/hash.h"

namespace relume {
namespace {

constexpr int kRooms = 5;   // along x, and along z
constexpr float kRoom = 9;  // metres from wall to wall
constexpr float kHeight = 5;
constexpr float kWall = 0.3f;  // thickness
constexpr float kExtent = kRooms * kRoom;
constexpr Vec2 kDoor{2.6f, 3.2f};  // width, height

/// Middle of the opening between a room and its neighbour, along the wall from the room's corner.
float door_offset(int i, int j, uint32_t axis) {
  const uint32_t h = hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), axis);
  return kRoom / 2 + (to_unit_float(h) - 0.5f) * 3.6f;
}

Opening door_at(float middle) { return {{middle - kDoor.x / 2, middle + kDoor.x / 2}, {-0.01f, kDoor.y}}; }

Mesh inner_walls() {
  Mesh mesh;
  for (int i = 1; i < kRooms; ++i) {
    std::vector<Opening> along_z;
    std::vector<Opening> along_x;
    for (int j = 0; j < kRooms; ++j) {
      const float start = static_cast<float>(j) * kRoom;
      along_z.push_back(door_at(start + door_offset(i, j, 0)));
      along_x.push_back(door_at(start + door_offset(i, j, 1)));
    }
    const float p = static_cast<float>(i) * kRoom;
    append(mesh, wall({p, 0}, {p, kExtent}, kWall, kHeight, along_z));
    append(mesh, wall({0, p}, {kExtent, p}, kWall, kHeight, along_x));
  }
  return mesh;
}

Vec3 room_middle(int i, int j, float y) {
  return {(static_cast<float>(i) + 0.5f) * kRoom, y, (static_cast<float>(j) + 0.5f) * kRoom};
}

/// Two rows in each room, which leave its middle free.
std::vector<Mat4> shelf_places() {
  std::vector<Mat4> places;
  for (int j = 0; j < kRooms; ++j) {
    for (int i = 0; i < kRooms; ++i) {
      const bool turned = hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 7u) % 2 == 1;
      for (const Vec2& p : {Vec2(-2.3f, -2.9f), Vec2(2.3f, -2.9f), Vec2(-2.3f, 2.9f), Vec2(2.3f, 2.9f)}) {
        places.push_back(translation(room_middle(i, j, 0)) * rotation_y(turned ? 90.0f : 0.0f) *
                         translation({p.x, 0, p.y}));
      }
    }
  }
  return places;
}

/// 14 lamps in each room: six tubes under the ceiling, and eight small ones under the highest boards.
void add_lamps(SceneBuilder& builder, const std::vector<Mat4>& shelves) {
  const Rgb colors[3] = {{70, 66, 60}, {80, 62, 40}, {52, 64, 78}};
  Mesh tubes[3];
  for (int j = 0; j < kRooms; ++j) {
    for (int i = 0; i < kRooms; ++i) {
      Mesh& mesh = tubes[hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 11u) % 3];
      for (int k = 0; k < 6; ++k) {
        const Vec3 middle((static_cast<float>(i) + 0.3f + 0.4f * static_cast<float>(k % 2)) * kRoom, kHeight - 0.4f,
                          (static_cast<float>(j) + 0.2f + 0.3f * static_cast<float>(k / 2)) * kRoom);
        append(mesh, quad(middle - Vec3(0.6f, 0, 0.06f), {1.2f, 0, 0}, {0, 0, 0.12f}));
      }
    }
  }
  for (int k = 0; k < 3; ++k) {
    const std::string name = "tubes " + std::to_string(k);
    builder.add(name, std::move(tubes[k]), builder.add_material(emitter(name, colors[k])));
  }
  Mesh small;
  for (const Mat4& place : shelves) {
    for (const float x : {-0.9f, 0.9f})
      append(small, transformed(quad({x - 0.15f, 1.83f, 0.34f}, {0.3f, 0, 0}, {0, 0, 0.06f}), place));
  }
  builder.add("shelf lamps", std::move(small), builder.add_material(emitter("shelf lamps", {60, 50, 36})));
}

}  // namespace

Scene build_warehouse_rooms() {
  SceneBuilder builder("warehouse-rooms");
  const Index concrete = builder.add_material(matte("concrete", {0.5f, 0.49f, 0.47f}));
  const Index plaster = builder.add_material(matte("plaster", {0.72f, 0.71f, 0.68f}));
  const Index floor = builder.add_material(glossy("floor", {0.36f, 0.36f, 0.37f}, 0.45f));
  builder.add("floor", quad({0, 0, kExtent}, {kExtent, 0, 0}, {0, 0, -kExtent}), floor);
  builder.add("ceiling", quad({0, kHeight, 0}, {kExtent, 0, 0}, {0, 0, kExtent}), concrete);
  Mesh outer;
  append(outer, quad({0, 0, 0}, {kExtent, 0, 0}, {0, kHeight, 0}));
  append(outer, quad({kExtent, 0, kExtent}, {-kExtent, 0, 0}, {0, kHeight, 0}));
  append(outer, quad({0, 0, kExtent}, {0, 0, -kExtent}, {0, kHeight, 0}));
  append(outer, quad({kExtent, 0, 0}, {0, 0, kExtent}, {0, kHeight, 0}));
  builder.add("outer walls", std::move(outer), plaster);
  builder.add("inner walls", inner_walls(), plaster);
  const std::vector<Mat4> shelves = shelf_places();
  add_shelves(builder, shelves);
  add_lamps(builder, shelves);

  // From room (2, 3) through the openings of (2, 2) and (3, 2).
  const Vec3 door_north(2 * kRoom + door_offset(3, 2, 1), 1.6f, 3 * kRoom);
  const Vec3 door_east(3 * kRoom, 1.6f, 2 * kRoom + door_offset(3, 2, 0));
  const Vec3 second = room_middle(2, 2, 1.7f);
  const Vec3 last = room_middle(3, 2, 1.7f);
  const Vec3 start = room_middle(2, 3, 3.2f) + Vec3(-2.4f, 0, 4.1f);
  const Index camera = builder.add_camera(start, door_north, 62);
  builder.add_camera_path(camera, {{0, start, door_north},
                                   {3, door_north + Vec3(0, 0, 1.5f), second},
                                   {5, second, door_east},
                                   {7, door_east, last},
                                   {10, last, last + Vec3(4, -0.2f, -2)}});
  return builder.take();
}

}  // namespace relume
