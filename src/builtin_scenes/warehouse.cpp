// A hall beside 16 by 16 narrow, high storage bays with one lamp each. A position in a bay sees only the bay's own
// lamp, and perhaps one through an opening; lamps behind the walls are nearly as close. Light selection without
// visibility, or by lists for cells wider than a bay (static lists: 4 m by default), wastes most shadow rays.
#include <string>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"

namespace relume {
namespace {

constexpr int kColumns = 16;  // number of bays along x
constexpr int kRows = 16;     // number of bays along z
constexpr float kBay = 3;     // metres from wall to wall
constexpr float kHeight = 6;
constexpr float kWall = 0.2f;  // thickness
constexpr float kWidth = kColumns * kBay;
constexpr float kDepth = kRows * kBay;
constexpr float kHall = 48;        // width of the hall, at larger x
constexpr Vec2 kDoor{1.1f, 2.1f};  // width, height

/// The camera moves from the first of these bays through the second into the third.
constexpr int kPath[3][2] = {{8, 8}, {8, 7}, {9, 7}};

enum Side : uint32_t { west, north };  // sides of a bay, towards smaller x and smaller z

/// Whether bay (i, j) has an opening on that side.
bool has_door(int i, int j, Side side) {
  if (side == west ? i == 0 : j == 0 || j == kRows) return false;
  if (i == kPath[0][0] && j == kPath[0][1] && side == north) return true;
  if (i == kPath[2][0] && j == kPath[2][1] && side == west) return true;
  return hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 3u + side) % 5 < 2;
}

/// Middle of that opening, along the wall from its corner.
float door_offset(int i, int j, Side side) {
  const uint32_t h = hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), static_cast<uint32_t>(side));
  return kBay / 2 + (to_unit_float(h) - 0.5f) * 0.8f;
}

Opening door_at(float middle) { return {{middle - kDoor.x / 2, middle + kDoor.x / 2}, {-0.01f, kDoor.y}}; }

Mesh inner_walls() {
  Mesh mesh;
  for (int i = 1; i <= kColumns; ++i) {
    std::vector<Opening> doors;
    for (int j = 0; j < kRows; ++j) {
      if (has_door(i, j, west)) doors.push_back(door_at(static_cast<float>(j) * kBay + door_offset(i, j, west)));
    }
    const float x = static_cast<float>(i) * kBay;
    append(mesh, wall({x, 0}, {x, kDepth}, kWall, kHeight, doors));
  }
  for (int j = 1; j < kRows; ++j) {
    std::vector<Opening> doors;
    for (int i = 0; i < kColumns; ++i) {
      if (has_door(i, j, north)) doors.push_back(door_at(static_cast<float>(i) * kBay + door_offset(i, j, north)));
    }
    const float z = static_cast<float>(j) * kBay;
    append(mesh, wall({0, z}, {kWidth, z}, kWall, kHeight, doors));
  }
  return mesh;
}

Vec3 bay_middle(int i, int j, float y) {
  return {(static_cast<float>(i) + 0.5f) * kBay, y, (static_cast<float>(j) + 0.5f) * kBay};
}

/// Shelves 3.6 m wide (x), 0.9 m deep (z) and 2.5 m high, about the centre of their floor.
Mesh shelf_frame() {
  Mesh mesh;
  for (const float x : {-1.8f, 1.72f}) {
    for (const float z : {-0.45f, 0.37f}) append(mesh, box({x, -0.01f, z}, {x + 0.08f, 2.5f, z + 0.08f}));
  }
  for (const float y : {0.25f, 1.05f, 1.85f}) append(mesh, box({-1.72f, y, -0.44f}, {1.72f, y + 0.04f, 0.44f}));
  return mesh;
}

/// Adds boxes on the boards, distributed over `parts` by a hash.
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

/// Positions of shelves: two on top of each other along walls without an opening.
std::vector<Mat4> shelf_places() {
  std::vector<Mat4> places;
  constexpr float kScale = 0.7f;
  const float back = kBay / 2 - kWall / 2 - 0.5f * kScale;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const bool closed[4] = {!has_door(i, j, north), !has_door(i, j, west), !has_door(i, j + 1, north),
                              !has_door(i + 1, j, west)};
      for (uint32_t side = 0; side < 4; ++side) {
        // In a corner where two would meet, only the first is placed. The camera's path begins at the south of its bay.
        if (!closed[side] || (side > 0 && closed[side - 1]) || (side == 3 && closed[0])) continue;
        if (side == 2 && i == kPath[0][0] && j == kPath[0][1]) continue;
        for (const float y : {0.0f, 2.5f * kScale}) {
          places.push_back(translation(bay_middle(i, j, y)) * rotation_y(90.0f * static_cast<float>(side)) *
                           translation({0, 0, -back}) * scaling(Vec3(kScale)));
        }
      }
    }
  }
  return places;
}

/// One lamp per bay under the ceiling, and twelve in the hall.
void add_lamps(SceneBuilder& builder) {
  const Rgb colors[3] = {{420, 396, 360}, {476, 373, 240}, {313, 385, 470}};
  Mesh lamps[3];
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      Mesh& mesh = lamps[hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 11u) % 3];
      append(mesh, quad(bay_middle(i, j, kHeight - 0.4f) - Vec3(0.4f, 0, 0.1f), {0.8f, 0, 0}, {0, 0, 0.2f}));
    }
  }
  for (int i = 0; i < 12; ++i) {
    const Vec3 middle(kWidth + (static_cast<float>(i % 4) + 0.5f) * kHall / 4, kHeight - 0.4f,
                      (static_cast<float>(i / 4) + 0.5f) * kDepth / 3);
    append(lamps[0], quad(middle - Vec3(0.6f, 0, 0.15f), {1.2f, 0, 0}, {0, 0, 0.3f}));
  }
  for (int k = 0; k < 3; ++k) {
    const std::string name = "lamps " + std::to_string(k);
    builder.add(name, std::move(lamps[k]), builder.add_material(emitter(name, colors[k])));
  }
}

void add_shelves(SceneBuilder& builder) {
  const std::vector<Mat4> places = shelf_places();
  const Index steel = builder.add_material(glossy("steel", {0.18f, 0.25f, 0.4f}, 0.35f));
  builder.add_instances("shelves", builder.add_mesh("shelves", shelf_frame(), steel), places);
  Mesh load[3];
  shelf_load(load);
  const Material materials[3] = {matte("cardboard", {0.52f, 0.38f, 0.24f}),
                                 glossy("crates", {0.55f, 0.16f, 0.1f}, 0.4f), matte("paper", {0.7f, 0.68f, 0.62f})};
  for (int k = 0; k < 3; ++k) {
    const std::string name = materials[k].name;
    builder.add_instances(name, builder.add_mesh(name, std::move(load[k]), builder.add_material(materials[k])), places);
  }
}

}  // namespace

Scene build_warehouse() {
  SceneBuilder builder("warehouse");
  const Index concrete = builder.add_material(matte("concrete", {0.2f, 0.19f, 0.18f}));
  const Index plaster = builder.add_material(matte("plaster", {0.2f, 0.2f, 0.19f}));
  const Index floor = builder.add_material(glossy("floor", {0.2f, 0.2f, 0.21f}, 0.45f));
  constexpr float kWholeWidth = kWidth + kHall;
  builder.add("floor", quad({0, 0, kDepth}, {kWholeWidth, 0, 0}, {0, 0, -kDepth}), floor);
  builder.add("ceiling", quad({0, kHeight, 0}, {kWholeWidth, 0, 0}, {0, 0, kDepth}), concrete);
  Mesh outer;
  append(outer, quad({0, 0, 0}, {kWholeWidth, 0, 0}, {0, kHeight, 0}));
  append(outer, quad({kWholeWidth, 0, kDepth}, {-kWholeWidth, 0, 0}, {0, kHeight, 0}));
  append(outer, quad({0, 0, kDepth}, {0, 0, -kDepth}, {0, kHeight, 0}));
  append(outer, quad({kWholeWidth, 0, 0}, {0, 0, kDepth}, {0, kHeight, 0}));
  builder.add("outer walls", std::move(outer), plaster);
  builder.add("inner walls", inner_walls(), plaster);
  add_shelves(builder);
  add_lamps(builder);

  const auto& [first, second, third] = kPath;
  const Vec3 door_north(static_cast<float>(first[0]) * kBay + door_offset(first[0], first[1], north), 1.6f,
                        static_cast<float>(first[1]) * kBay);
  const Vec3 door_east(static_cast<float>(third[0]) * kBay, 1.6f,
                       static_cast<float>(third[1]) * kBay + door_offset(third[0], third[1], west));
  const Vec3 start = bay_middle(first[0], first[1], 2.4f) + Vec3(0.4f, 0, 1.3f);
  const Vec3 last = bay_middle(third[0], third[1], 1.7f);
  const Index camera = builder.add_camera(start, door_north, 62);
  builder.add_camera_path(camera, {{0, start, door_north},
                                   {3, door_north + Vec3(0, 0, 1), bay_middle(second[0], second[1], 1.7f)},
                                   {5, bay_middle(second[0], second[1], 1.7f), door_east},
                                   {7, door_east, last},
                                   {10, last, last + Vec3(1.2f, -0.2f, -0.6f)}});
  return builder.take();
}

}  // namespace relume
