// Five by five storage rooms with 350 lamps. From any place only the lamps of one room, and a few through the
// openings, are visible; choosing lamps without regard to visibility wastes nearly every shadow ray.
#include <string>
#include <vector>

#include "core/hash.h"
#include "scene/builtin/builder.h"
#include "scene/builtin/rooms.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

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

Mesh inner_walls() {
  Mesh mesh;
  for (int i = 1; i < kRooms; ++i) {
    std::vector<Opening> along_z;
    std::vector<Opening> along_x;
    for (int j = 0; j < kRooms; ++j) {
      const float start = static_cast<float>(j) * kRoom;
      const float z = start + door_offset(i, j, 0);
      const float x = start + door_offset(i, j, 1);
      along_z.push_back({{z - kDoor.x / 2, z + kDoor.x / 2}, {-0.01f, kDoor.y}});
      along_x.push_back({{x - kDoor.x / 2, x + kDoor.x / 2}, {-0.01f, kDoor.y}});
    }
    const float p = static_cast<float>(i) * kRoom;
    append(mesh, wall({p, 0}, {p, kExtent}, kWall, kHeight, along_z));
    append(mesh, wall({0, p}, {kExtent, p}, kWall, kHeight, along_x));
  }
  return mesh;
}

/// A unit of shelves 3.6 m wide (x), 0.9 m deep (z) and 2.5 m high, about the middle of its floor.
Mesh shelf_frame() {
  Mesh mesh;
  for (const float x : {-1.8f, 1.72f}) {
    for (const float z : {-0.45f, 0.37f}) append(mesh, box({x, -0.01f, z}, {x + 0.08f, 2.5f, z + 0.08f}));
  }
  for (const float y : {0.25f, 1.05f, 1.85f}) append(mesh, box({-1.72f, y, -0.44f}, {1.72f, y + 0.04f, 0.44f}));
  return mesh;
}

/// What lies on the boards: every third box into `parts[0]`, and so on.
void shelf_load(Mesh (&parts)[3]) {
  uint32_t n = 0;
  for (const float y : {0.29f, 1.09f, 1.89f}) {
    float x = -1.65f;
    while (true) {
      const float width = 0.3f + 0.45f * to_unit_float(hash(n, 1u));
      if (x + width > 1.65f) break;
      const float height = 0.2f + 0.4f * to_unit_float(hash(n, 2u));
      const float depth = 0.25f + 0.14f * to_unit_float(hash(n, 3u));
      append(parts[hash(n, 4u) % 3], box({x, y - 0.005f, -depth}, {x + width, y + height, depth}));
      x += width + 0.04f + 0.2f * to_unit_float(hash(n, 5u));
      ++n;
    }
  }
}

/// Where the shelves of room (i, j) stand: two rows that leave the middle free.
std::vector<Mat4> shelf_places() {
  std::vector<Mat4> places;
  for (int j = 0; j < kRooms; ++j) {
    for (int i = 0; i < kRooms; ++i) {
      const bool turned = hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 7u) % 2 == 1;
      const Vec3 middle((static_cast<float>(i) + 0.5f) * kRoom, 0, (static_cast<float>(j) + 0.5f) * kRoom);
      for (const Vec2 p : {Vec2(-2.3f, -2.9f), Vec2(2.3f, -2.9f), Vec2(-2.3f, 2.9f), Vec2(2.3f, 2.9f)}) {
        places.push_back(translation(middle) * rotation_y(turned ? 90.0f : 0.0f) * translation({p.x, 0, p.y}));
      }
    }
  }
  return places;
}

/// 14 lamps a room: six tubes under the ceiling, and eight small ones under the boards of the shelves.
void add_lamps(SceneBuilder& builder) {
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
  for (const Mat4& place : shelf_places()) {
    for (const float x : {-0.9f, 0.9f}) {
      append(small, transformed(quad({x - 0.15f, 1.83f, 0.34f}, {0.3f, 0, 0}, {0, 0, 0.06f}), place));
    }
  }
  builder.add("shelf lamps", std::move(small), builder.add_material(emitter("shelf lamps", {60, 50, 36})));
}

void add_shelves(SceneBuilder& builder) {
  const std::vector<Mat4> places = shelf_places();
  const Index steel = builder.add_material(glossy("steel", {0.18f, 0.25f, 0.4f}, 0.35f));
  builder.add_instances("shelves", builder.add_mesh("shelves", shelf_frame(), steel), places);
  Mesh load[3];
  shelf_load(load);
  const Material materials[3] = {lambert("cardboard", {0.52f, 0.38f, 0.24f}),
                                 glossy("crates", {0.55f, 0.16f, 0.1f}, 0.4f), lambert("paper", {0.7f, 0.68f, 0.62f})};
  for (int k = 0; k < 3; ++k) {
    const std::string name = materials[k].name;
    builder.add_instances(name, builder.add_mesh(name, std::move(load[k]), builder.add_material(materials[k])), places);
  }
}

Vec3 room_middle(int i, int j) {
  return {(static_cast<float>(i) + 0.5f) * kRoom, 1.7f, (static_cast<float>(j) + 0.5f) * kRoom};
}

}  // namespace

Scene build_warehouse() {
  SceneBuilder builder("warehouse");
  const Index concrete = builder.add_material(lambert("concrete", {0.5f, 0.49f, 0.47f}));
  const Index plaster = builder.add_material(lambert("plaster", {0.72f, 0.71f, 0.68f}));
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
  add_shelves(builder);
  add_lamps(builder);

  // From room (2, 3) through the openings of (2, 2) and (3, 2).
  const Vec3 door_north((2 * kRoom) + door_offset(3, 2, 1), 1.6f, 3 * kRoom);
  const Vec3 door_east(3 * kRoom, 1.6f, 2 * kRoom + door_offset(3, 2, 0));
  const Vec3 start = room_middle(2, 3) + Vec3(-2.4f, 1.5f, 4.1f);
  const Index camera = builder.add_camera(start, door_north, 62);
  builder.add_camera_path(camera, {{0, start, door_north},
                                   {3, door_north + Vec3(0, 0, 1.5f), room_middle(2, 2)},
                                   {5, room_middle(2, 2), door_east},
                                   {7, door_east, room_middle(3, 2)},
                                   {10, room_middle(3, 2), room_middle(3, 2) + Vec3(4, -0.2f, -2)}});
  return builder.take();
}

}  // namespace relume
