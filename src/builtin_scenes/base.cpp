// A base of 40 to 60 rooms with strips, panels and screens as lamps, after the levels of Quake II. Doors sink into the
// floor, some lamps flicker, one room has a skylight, and the camera walks through the rooms.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <glm/trigonometric.hpp>

#include "builtin_scenes/base_plan.h"
#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"
#include "core/hash.h"

namespace relume {
namespace {

constexpr float kHeight = 3.2f;
constexpr float kWallThickness = 0.2f;
constexpr float kDoorHeight = 2.2f;
constexpr float kEye = 1.6f;
constexpr float kLampHeight = kHeight - 0.03f;
constexpr float kHole = 1.5f;  // edge of the skylight

/// At height y over p.
Vec3 over(const Vec2& p, float y) { return {p.x, y, p.y}; }

/// A lamp under the ceiling that faces down, centred at p.
Mesh ceiling_lamp(const Vec2& p, const Vec2& size) {
  return quad(over(p - 0.5f * size, kLampHeight), {size.x, 0, 0}, {0, 0, size.y});
}

/// Two rows of eight quads along the longer side of the room.
Mesh strips(const BaseRoom& room) {
  const Vec2 size = room.high - room.low;
  const int along = size.x >= size.y ? 0 : 1;
  Mesh mesh;
  for (const float across : {0.3f, 0.7f}) {
    for (int i = 0; i < 8; ++i) {
      Vec2 share(across);
      share[along] = 0.1f + 0.1f * (static_cast<float>(i) + 0.5f);
      Vec2 lamp(0.12f);
      lamp[along] = 0.08f * size[along];
      append(mesh, ceiling_lamp(room.low + share * size, lamp));
    }
  }
  return mesh;
}

/// A grid of square lamps.
Mesh grid(const BaseRoom& room, int columns, int rows, float edge) {
  Mesh mesh;
  for (int i = 0; i < columns * rows; ++i) {
    const Vec2 share((static_cast<float>(i % columns) + 0.5f) / static_cast<float>(columns),
                     (static_cast<float>(i / columns) + 0.5f) / static_cast<float>(rows));
    append(mesh, ceiling_lamp(room.low + share * (room.high - room.low), Vec2(edge)));
  }
  return mesh;
}

/// Six screens on each of the walls at the smallest and largest x, above the doors.
Mesh screens(const BaseRoom& room) {
  constexpr float kBottom = kDoorHeight + 0.1f;
  constexpr float kScreen = 0.7f;  // height
  const float step = (room.high.y - room.low.y - 1) / 6;
  const float offset = kWallThickness / 2 + 0.02f;
  Mesh mesh;
  for (int i = 0; i < 6; ++i) {
    const float z = room.low.y + 0.5f + step * static_cast<float>(i);
    append(mesh, quad({room.low.x + offset, kBottom, z + 0.95f * step}, {0, 0, -0.9f * step}, {0, kScreen, 0}));
    append(mesh, quad({room.high.x - offset, kBottom, z + 0.05f * step}, {0, 0, 0.9f * step}, {0, kScreen, 0}));
  }
  return mesh;
}

/// Coloured bars, dark gaps and a few bright squares.
Texture screen_texture(uint32_t seed) {
  Texture texture;
  texture.name = "screen";
  texture.width = 64;
  texture.height = 32;
  for (uint32_t y = 0; y < 32; ++y) {
    for (uint32_t x = 0; x < 64; ++x) {
      const uint32_t bar = hash(x / 8, y / 16, seed);
      const bool is_gap = y % 4 == 3;
      const bool is_bright = hash(x / 4, y / 4, seed + 1) % 7 == 0;
      for (uint32_t c = 0; c < 3; ++c) {
        const uint32_t color = 60 + (bar >> (8 * c)) % 120;
        texture.texels.push_back(static_cast<std::byte>(is_bright ? 255 : is_gap ? 20 : color));
      }
      texture.texels.push_back(std::byte{255});
    }
  }
  return texture;
}

class BaseBuilder {
 public:
  BaseBuilder(std::string name, uint32_t seed)
      : builder_(std::move(name)), seed_(seed), plan_(make_base_plan(seed)), keys_(walk()) {}

  Scene build() {
    add_shell();
    add_inner_walls();
    add_doors();
    add_lamps();
    add_crates();
    add_walk();
    add_sky();
    add_visible_sets();
    return builder_.take();
  }

 private:
  float end_s() const { return BasePlan::kWait_s + BasePlan::kStep_s * static_cast<float>(plan_.walk_doors.size()); }

  void add_shell() {
    constexpr float kX = BasePlan::kWidth;
    constexpr float kZ = BasePlan::kDepth;
    builder_.add("floor", quad({0, 0, kZ}, {kX, 0, 0}, {0, 0, -kZ}),
                 builder_.add_material(glossy("floor", {0.32f, 0.3f, 0.28f}, 0.45f)));
    Mesh ceiling;
    for (const BaseRoom& room : plan_.rooms) {
      const auto part = [&](const Vec2& low, const Vec2& high) {
        append(ceiling, quad(over(low, kHeight), {high.x - low.x, 0, 0}, {0, 0, high.y - low.y}));
      };
      if (room.lamps != BaseLamps::skylight) {
        part(room.low, room.high);
        continue;
      }
      const Vec2 low = room.middle() - kHole / 2;
      const Vec2 high = room.middle() + kHole / 2;
      part(room.low, {low.x, room.high.y});
      part({high.x, room.low.y}, room.high);
      part({low.x, room.low.y}, {high.x, low.y});
      part({low.x, high.y}, {high.x, room.high.y});
    }
    builder_.add("ceiling", std::move(ceiling), builder_.add_material(matte("ceiling", {0.5f, 0.5f, 0.5f})));
    plaster_ = builder_.add_material(matte("plaster", {0.55f, 0.52f, 0.47f}));
    Mesh outer = quad({0, 0, 0}, {kX, 0, 0}, {0, kHeight, 0});
    append(outer, quad({kX, 0, kZ}, {-kX, 0, 0}, {0, kHeight, 0}));
    append(outer, quad({0, 0, kZ}, {0, 0, -kZ}, {0, kHeight, 0}));
    append(outer, quad({kX, 0, 0}, {0, 0, kZ}, {0, kHeight, 0}));
    builder_.add("outer walls", std::move(outer), plaster_);
  }

  void add_inner_walls() {
    Mesh parts[2];
    for (size_t i = 0; i < plan_.walls.size(); ++i) {
      const BaseWall& part = plan_.walls[i];
      std::vector<Opening> openings;
      if (part.door >= 0) {
        const float middle = glm::distance(part.a, plan_.doors[static_cast<size_t>(part.door)].middle());
        openings.push_back(
            {{middle - BasePlan::kDoorWidth / 2, middle + BasePlan::kDoorWidth / 2}, {-0.01f, kDoorHeight}});
      }
      append(parts[hash(seed_, static_cast<uint32_t>(i), 101u) % 2],
             wall(part.a, part.b, kWallThickness, kHeight, openings));
    }
    builder_.add("inner walls", std::move(parts[0]), plaster_);
    builder_.add("panelled walls", std::move(parts[1]), builder_.add_material(matte("panels", {0.3f, 0.36f, 0.34f})));
  }

  /// Leaves, closed at first. Each overlaps its frame by 2 cm, so that no light passes.
  void add_doors() {
    const Index steel = builder_.add_material(metal("steel", {0.5f, 0.5f, 0.52f}, 0.4f));
    constexpr float kHalf = BasePlan::kDoorWidth / 2 + 0.02f;
    for (size_t i = 0; i < plan_.doors.size(); ++i) {
      const BaseDoor& door = plan_.doors[i];
      if (!door.has_leaf) continue;
      const Vec2 half = door.along_x ? Vec2(kHalf, 0.03f) : Vec2(0.03f, kHalf);
      Transform closed;
      closed.translation = over(door.middle(), 0);
      AnimationChannel channel;
      channel.node =
          builder_.add("door " + std::to_string(i),
                       box({-half.x, -0.01f, -half.y}, {half.x, kDoorHeight + 0.01f, half.y}), steel, closed);
      const Vec4 up(closed.translation, 0);
      const Vec4 down = up - Vec4(0, kDoorHeight + 0.05f, 0, 0);
      channel.times = {0, door.opens_s, door.opens_s + 1, door.closes_s, door.closes_s + 1};
      channel.values = {up, up, down, down, up};
      builder_.add_channel(std::move(channel));
    }
  }

  void add_lamps() {
    Mesh lamps[4];
    Mesh flickering;
    int with_strips = 0;
    for (const BaseRoom& room : plan_.rooms) {
      switch (room.lamps) {
        case BaseLamps::strips: append(with_strips++ % 4 == 0 ? flickering : lamps[0], strips(room)); break;
        case BaseLamps::panels: append(lamps[1], grid(room, 4, 3, 0.4f)); break;
        case BaseLamps::screens: append(lamps[2], screens(room)); break;
        case BaseLamps::dim: append(lamps[3], grid(room, 2, 2, 0.15f)); break;
        case BaseLamps::skylight: break;
      }
    }
    Material materials[4] = {emitter("strips", {95, 100, 105}), emitter("lit panels", {50, 42, 30}),
                             emitter("screens", {16, 18, 20}), emitter("dim lamps", {90, 45, 20})};
    materials[2].emission_texture.texture = builder_.add_texture(screen_texture(seed_));
    for (int k = 0; k < 4; ++k) {
      const std::string name = materials[k].name;
      if (!lamps[k].triangles.empty()) builder_.add(name, std::move(lamps[k]), builder_.add_material(materials[k]));
    }
    add_flicker(std::move(flickering));
  }

  /// Lamps of every fourth room with strips. Their power is full, or a fifth for tenths of a second.
  void add_flicker(Mesh mesh) {
    const Rgb full(95, 100, 105);
    ParameterChannel channel;
    channel.part = AnimatedPart::material;
    channel.index = builder_.add_material(emitter("flickering strips", full));
    channel.parameter = "emission";
    channel.interpolation = Interpolation::step;
    const auto steps = static_cast<uint32_t>(std::lround(10 * end_s()));
    for (uint32_t i = 0; i <= steps; ++i) {
      const bool is_low = i > 0 && hash(seed_, i / 3, 103u) % 3 == 0 && hash(seed_, i, 104u) % 2 == 0;
      channel.times.push_back(0.1f * static_cast<float>(i));
      channel.values.emplace_back(full * (is_low ? 0.2f : 1.0f), 0);
    }
    builder_.add("flickering strips", std::move(mesh), channel.index);
    builder_.add_channel(std::move(channel));
  }

  /// One in a quarter of most rooms, at least a metre from the walk.
  void add_crates() {
    Mesh mesh;
    for (uint32_t i = 0; i < plan_.rooms.size(); ++i) {
      const BaseRoom& room = plan_.rooms[i];
      const uint32_t quarter = hash(seed_, i, 105u);
      const Vec2 share(quarter % 2 == 0 ? 0.25f : 0.75f, quarter / 2 % 2 == 0 ? 0.25f : 0.75f);
      const Vec2 p = room.low + share * (room.high - room.low);
      const bool in_the_way = std::any_of(
          keys_.begin(), keys_.end(), [&](const CameraKey& key) { return glm::distance(over(p, kEye), key.eye) < 1; });
      if (in_the_way) continue;
      const float half = 0.25f + 0.1f * to_unit_float(hash(seed_, i, 106u));
      append(mesh, box(over(p - half, -0.01f), over(p + half, 2 * half)));
    }
    builder_.add("crates", std::move(mesh), builder_.add_material(matte("crates", {0.45f, 0.3f, 0.16f})));
  }

  /// Points of the walk in the plan, with their times: waiting, then middle of a room and both sides of the next door.
  /// The last point lies beyond the last room.
  std::vector<std::pair<float, Vec2>> way() const {
    std::vector<std::pair<float, Vec2>> points = {{0.0f, plan_.rooms[plan_.walk[0]].middle()}};
    for (size_t k = 0; k < plan_.walk.size(); ++k) {
      const float time_s = BasePlan::kWait_s + BasePlan::kStep_s * static_cast<float>(k);
      points.emplace_back(time_s, plan_.rooms[plan_.walk[k]].middle());
      if (k == plan_.walk_doors.size()) break;
      const BaseDoor& door = plan_.doors[plan_.walk_doors[k]];
      const Vec2 ahead = door.along_x ? Vec2(0, 0.8f) : Vec2(0.8f, 0);
      const float sign = door.portal.rooms[0] == plan_.walk[k] ? 1.0f : -1.0f;
      points.emplace_back(time_s + 0.9f, door.middle() - sign * ahead);
      points.emplace_back(time_s + 1.6f, door.middle() + sign * ahead);
    }
    const Vec2 last = points.back().second;
    points.emplace_back(end_s() + 3, last + 3.0f * glm::normalize(last - points[points.size() - 2].second));
    return points;
  }

  /// Position on the polyline, averaged over 0.6 s. The average is in the room, or straight on the way through a door.
  static Vec2 smooth_position(const std::vector<std::pair<float, Vec2>>& points, float time_s) {
    Vec2 sum(0);
    for (int i = -3; i <= 3; ++i) {
      const float t = time_s + 0.1f * static_cast<float>(i);
      size_t k = 1;
      while (k + 1 < points.size() && points[k].first <= t) ++k;
      const auto& [from_s, from] = points[k - 1];
      const auto& [to_s, to] = points[k];
      sum += from + saturate((t - from_s) / (to_s - from_s)) * (to - from);
    }
    return sum / 7.0f;
  }

  /// The camera looks at the place where it is 2.2 s later.
  std::vector<CameraKey> walk() const {
    const std::vector<std::pair<float, Vec2>> points = way();
    std::vector<CameraKey> keys;
    for (int i = 0; i <= static_cast<int>(std::lround(10 * end_s())); ++i) {
      const float time_s = 0.1f * static_cast<float>(i);
      keys.push_back({time_s, over(smooth_position(points, time_s), kEye),
                      over(smooth_position(points, time_s + 2.2f), kEye - 0.1f)});
    }
    return keys;
  }

  void add_walk() { builder_.add_camera_path(builder_.add_camera(keys_.front().eye, keys_.front().target, 70), keys_); }

  void add_sky() {
    Environment environment;
    environment.kind = EnvironmentKind::sun_sky;
    environment.sun_sky.sun_elevation_rad = glm::radians(60.0f);
    environment.sun_sky.sun_azimuth_rad = glm::radians(35.0f);
    environment.sun_sky.sun_angular_diameter_rad = glm::radians(1.0f);
    builder_.set_environment(environment);
  }

  /// What the rooms see when all doors are open.
  void add_visible_sets() {
    const auto visible = visible_rooms(static_cast<uint32_t>(plan_.rooms.size()), plan_.portals());
    std::vector<VisibleSet> sets;
    for (size_t i = 0; i < plan_.rooms.size(); ++i)
      sets.push_back({over(plan_.rooms[i].low, 0), over(plan_.rooms[i].high, kHeight), visible[i]});
    builder_.set_visible_sets(std::move(sets));
  }

  SceneBuilder builder_;
  uint32_t seed_;
  BasePlan plan_;
  std::vector<CameraKey> keys_;
  Index plaster_ = kNone;
};

}  // namespace

Scene build_base(uint32_t seed) { return BaseBuilder("base-" + std::to_string(seed), seed).build(); }

}  // namespace relume
