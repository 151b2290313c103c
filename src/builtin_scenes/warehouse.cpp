// Narrow, high storage bays. A position in a bay sees only the bay's own lamps, and perhaps some through an opening;
// lamps behind the walls are nearly as close. Light selection without visibility, or by lists for cells wider than a
// bay (static lists: 4 m by default), wastes most shadow rays. The default layout has a hall beside 16 by 16 bays.
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

enum Side : uint32_t { west, north };  // sides of a bay, towards smaller x and smaller z

/// Lengths in metres.
struct Layout {
  std::string name;
  int columns;  ///< number of bays along x
  int rows;     ///< number of bays along z
  float bay;    ///< from wall to wall
  float height;
  float wall;         ///< thickness
  float hall;         ///< width of the hall at larger x; 0: none
  Vec2 door;          ///< width, height
  float door_spread;  ///< range of the openings' positions along their wall
  float shelf_scale;
  float shelf_step;             ///< height of the upper shelf's floor
  Vec2 lamp;                    ///< half width along x, half depth along z
  std::vector<float> lamps_at;  ///< offsets of a bay's lamps along z
  Rgb lamp_colors[3];           ///< radiance
  Rgb concrete;                 ///< albedos
  Rgb plaster;
  Rgb floor;
  int path[3][2];     ///< the camera moves from the first of these bays through the second into the third
  Vec3 start;         ///< first position of the camera: height, and offset from the bay's vertical axis
  float before_door;  ///< distance of the second key from the first opening
  Vec3 last_view;     ///< final direction
};

/// Bays of `layout`, and the openings between them.
class Bays {
 public:
  explicit Bays(Layout layout)
      : l_(std::move(layout)),
        width_(static_cast<float>(l_.columns) * l_.bay),
        depth_(static_cast<float>(l_.rows) * l_.bay) {}

  Scene build() const {
    SceneBuilder builder(l_.name);
    const Index concrete = builder.add_material(matte("concrete", l_.concrete));
    const Index plaster = builder.add_material(matte("plaster", l_.plaster));
    const Index floor = builder.add_material(glossy("floor", l_.floor, 0.45f));
    const float whole_width = width_ + l_.hall;
    builder.add("floor", quad({0, 0, depth_}, {whole_width, 0, 0}, {0, 0, -depth_}), floor);
    builder.add("ceiling", quad({0, l_.height, 0}, {whole_width, 0, 0}, {0, 0, depth_}), concrete);
    Mesh outer;
    append(outer, quad({0, 0, 0}, {whole_width, 0, 0}, {0, l_.height, 0}));
    append(outer, quad({whole_width, 0, depth_}, {-whole_width, 0, 0}, {0, l_.height, 0}));
    append(outer, quad({0, 0, depth_}, {0, 0, -depth_}, {0, l_.height, 0}));
    append(outer, quad({whole_width, 0, 0}, {0, 0, depth_}, {0, l_.height, 0}));
    builder.add("outer walls", std::move(outer), plaster);
    builder.add("inner walls", inner_walls(), plaster);
    add_shelves(builder, shelf_places());
    add_lamps(builder);
    add_path(builder);
    return builder.take();
  }

 private:
  /// Whether bay (i, j) has an opening on that side.
  bool has_door(int i, int j, Side side) const {
    const bool outer = side == west ? i == 0 || (i == l_.columns && l_.hall == 0) : j == 0 || j == l_.rows;
    if (outer) return false;
    if (i == l_.path[0][0] && j == l_.path[0][1] && side == north) return true;
    if (i == l_.path[2][0] && j == l_.path[2][1] && side == west) return true;
    return hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 3u + side) % 5 < 2;
  }

  /// Middle of that opening, along the wall from its corner.
  float door_offset(int i, int j, Side side) const {
    const uint32_t h = hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), static_cast<uint32_t>(side));
    return l_.bay / 2 + (to_unit_float(h) - 0.5f) * l_.door_spread;
  }

  Opening door_at(float middle) const {
    return {{middle - l_.door.x / 2, middle + l_.door.x / 2}, {-0.01f, l_.door.y}};
  }

  Mesh inner_walls() const {
    Mesh mesh;
    const int last = l_.hall > 0 ? l_.columns : l_.columns - 1;
    for (int i = 1; i <= last; ++i) {
      std::vector<Opening> doors;
      for (int j = 0; j < l_.rows; ++j) {
        if (has_door(i, j, west)) doors.push_back(door_at(static_cast<float>(j) * l_.bay + door_offset(i, j, west)));
      }
      const float x = static_cast<float>(i) * l_.bay;
      append(mesh, wall({x, 0}, {x, depth_}, l_.wall, l_.height, doors));
    }
    for (int j = 1; j < l_.rows; ++j) {
      std::vector<Opening> doors;
      for (int i = 0; i < l_.columns; ++i) {
        if (has_door(i, j, north)) doors.push_back(door_at(static_cast<float>(i) * l_.bay + door_offset(i, j, north)));
      }
      const float z = static_cast<float>(j) * l_.bay;
      append(mesh, wall({0, z}, {width_, z}, l_.wall, l_.height, doors));
    }
    return mesh;
  }

  Vec3 bay_middle(int i, int j, float y) const {
    return {(static_cast<float>(i) + 0.5f) * l_.bay, y, (static_cast<float>(j) + 0.5f) * l_.bay};
  }

  /// Positions of shelves: two on top of each other along walls without an opening.
  std::vector<Mat4> shelf_places() const {
    std::vector<Mat4> places;
    const float back = l_.bay / 2 - l_.wall / 2 - 0.5f * l_.shelf_scale;
    for (int j = 0; j < l_.rows; ++j) {
      for (int i = 0; i < l_.columns; ++i) {
        const bool closed[4] = {!has_door(i, j, north), !has_door(i, j, west), !has_door(i, j + 1, north),
                                !has_door(i + 1, j, west)};
        for (uint32_t side = 0; side < 4; ++side) {
          // In a corner where two would meet, only the first is placed. The camera's path begins at the south of its
          // bay.
          if (!closed[side] || (side > 0 && closed[side - 1]) || (side == 3 && closed[0])) continue;
          if (side == 2 && i == l_.path[0][0] && j == l_.path[0][1]) continue;
          for (const float y : {0.0f, l_.shelf_step}) {
            places.push_back(translation(bay_middle(i, j, y)) * rotation_y(90.0f * static_cast<float>(side)) *
                             translation({0, 0, -back}) * scaling(Vec3(l_.shelf_scale)));
          }
        }
      }
    }
    return places;
  }

  /// Lamps under the ceiling of each bay, and twelve in the hall.
  void add_lamps(SceneBuilder& builder) const {
    Mesh lamps[3];
    for (int j = 0; j < l_.rows; ++j) {
      for (int i = 0; i < l_.columns; ++i) {
        Mesh& mesh = lamps[hash(static_cast<uint32_t>(i), static_cast<uint32_t>(j), 11u) % 3];
        for (const float z : l_.lamps_at) {
          const Vec3 middle = bay_middle(i, j, l_.height - 0.4f) + Vec3(0, 0, z);
          append(mesh, quad(middle - Vec3(l_.lamp.x, 0, l_.lamp.y), {2 * l_.lamp.x, 0, 0}, {0, 0, 2 * l_.lamp.y}));
        }
      }
    }
    for (int i = 0; l_.hall > 0 && i < 12; ++i) {
      const Vec3 middle(width_ + (static_cast<float>(i % 4) + 0.5f) * l_.hall / 4, l_.height - 0.4f,
                        (static_cast<float>(i / 4) + 0.5f) * depth_ / 3);
      append(lamps[0], quad(middle - Vec3(0.6f, 0, 0.15f), {1.2f, 0, 0}, {0, 0, 0.3f}));
    }
    for (int k = 0; k < 3; ++k) {
      const std::string name = "lamps " + std::to_string(k);
      builder.add(name, std::move(lamps[k]), builder.add_material(emitter(name, l_.lamp_colors[k])));
    }
  }

  void add_path(SceneBuilder& builder) const {
    const auto& [first, second, third] = l_.path;
    const Vec3 door_north(static_cast<float>(first[0]) * l_.bay + door_offset(first[0], first[1], north), 1.6f,
                          static_cast<float>(first[1]) * l_.bay);
    const Vec3 door_east(static_cast<float>(third[0]) * l_.bay, 1.6f,
                         static_cast<float>(third[1]) * l_.bay + door_offset(third[0], third[1], west));
    const Vec3 start = bay_middle(first[0], first[1], l_.start.y) + Vec3(l_.start.x, 0, l_.start.z);
    const Vec3 last = bay_middle(third[0], third[1], 1.7f);
    const Index camera = builder.add_camera(start, door_north, 62);
    builder.add_camera_path(camera,
                            {{0, start, door_north},
                             {3, door_north + Vec3(0, 0, l_.before_door), bay_middle(second[0], second[1], 1.7f)},
                             {5, bay_middle(second[0], second[1], 1.7f), door_east},
                             {7, door_east, last},
                             {10, last, last + l_.last_view}});
  }

  Layout l_;
  float width_;
  float depth_;
};

/// Bays of 4.4 m with `lamps_at` and no hall.
Layout wide_bays(std::string name, int columns, int rows, std::vector<float> lamps_at, const Vec2& lamp) {
  return {.name = std::move(name),
          .columns = columns,
          .rows = rows,
          .bay = 4.4f,
          .height = 7,
          .wall = 0.3f,
          .hall = 0,
          .door = {1.5f, 2.3f},
          .door_spread = 1.2f,
          .shelf_scale = 1,
          .shelf_step = 2.49f,
          .lamp = lamp,
          .lamps_at = std::move(lamps_at),
          .lamp_colors = {{205, 193, 176}, {234, 182, 117}, {152, 188, 229}},
          .concrete = {0.34f, 0.33f, 0.32f},
          .plaster = {0.42f, 0.41f, 0.39f},
          .floor = {0.26f, 0.26f, 0.27f},
          .path = {{6, 5}, {6, 4}, {7, 4}},
          .start = {0.5f, 2.6f, 1.85f},
          .before_door = 1.2f,
          .last_view = {4, -0.2f, -2}};
}

}  // namespace

Scene build_warehouse() {
  return Bays({.name = "warehouse",
               .columns = 16,
               .rows = 16,
               .bay = 3,
               .height = 6,
               .wall = 0.2f,
               .hall = 48,
               .door = {1.1f, 2.1f},
               .door_spread = 0.8f,
               .shelf_scale = 0.7f,
               .shelf_step = 2.5f * 0.7f,
               .lamp = {0.4f, 0.1f},
               .lamps_at = {0},
               .lamp_colors = {{420, 396, 360}, {476, 373, 240}, {313, 385, 470}},
               .concrete = {0.2f, 0.19f, 0.18f},
               .plaster = {0.2f, 0.2f, 0.19f},
               .floor = {0.2f, 0.2f, 0.21f},
               .path = {{8, 8}, {8, 7}, {9, 7}},
               .start = {0.4f, 2.4f, 1.3f},
               .before_door = 1,
               .last_view = {1.2f, -0.2f, -0.6f}})
      .build();
}

Scene build_warehouse_140() {
  return Bays(wide_bays("warehouse-140", 14, 10, {-1.3f, 0, 1.3f}, {0.6f, 0.06f})).build();
}

Scene build_warehouse_399() { return Bays(wide_bays("warehouse-399", 21, 19, {0}, {0.6f, 0.18f})).build(); }

}  // namespace relume
