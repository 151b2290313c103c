#include "builtin_scenes/base_plan.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>
#include <utility>

#include "core/hash.h"

namespace relume {
namespace {

constexpr float kLeastSide = 3;    // metres, of rooms
constexpr float kMargin = 0.4f;    // between a door and the end of its wall
constexpr size_t kMostWalked = 9;  // rooms of the walk

/// What a random number decides.
enum Decision : uint32_t { room_count, split, lamps, spanning, extra_door, door_position, leaf, opening, closing };

class Planner {
 public:
  explicit Planner(uint32_t seed) : seed_(seed) {}

  BasePlan make() {
    split_rooms();
    choose_lamps();
    find_walls();
    add_doors();
    find_walk();
    time_doors();
    return std::move(plan_);
  }

 private:
  uint32_t number(Decision what, uint32_t i) const { return hash(seed_, what, i); }
  float random(Decision what, uint32_t i) const { return to_unit_float(number(what, i)); }

  /// Splits the largest room across its longer side until there are enough.
  void split_rooms() {
    const size_t count = 40 + number(room_count, 0) % 21;
    plan_.rooms.push_back({Vec2(0), {BasePlan::kWidth, BasePlan::kDepth}});
    const auto area = [](const BaseRoom& r) { return (r.high.x - r.low.x) * (r.high.y - r.low.y); };
    while (plan_.rooms.size() < count) {
      const auto n = static_cast<uint32_t>(plan_.rooms.size());
      const auto largest = std::max_element(plan_.rooms.begin(), plan_.rooms.end(),
                                            [&](const BaseRoom& a, const BaseRoom& b) { return area(a) < area(b); });
      const Vec2 size = largest->high - largest->low;
      const int axis = size.x >= size.y ? 0 : 1;
      const float share = 0.35f + 0.3f * random(split, n);
      const float at = largest->low[axis] + clamp(std::round(share * size[axis]), kLeastSide, size[axis] - kLeastSide);
      BaseRoom second = *largest;
      second.low[axis] = at;
      largest->high[axis] = at;
      plan_.rooms.push_back(second);
    }
  }

  /// Four, three, two and one tenth of the rooms have strips, panels, screens and a dim lamp.
  void choose_lamps() {
    for (uint32_t i = 0; i < plan_.rooms.size(); ++i) {
      const uint32_t n = number(lamps, i) % 10;
      plan_.rooms[i].lamps = n < 4   ? BaseLamps::strips
                             : n < 7 ? BaseLamps::panels
                             : n < 9 ? BaseLamps::screens
                                     : BaseLamps::dim;
    }
  }

  void find_walls() {
    const auto count = static_cast<uint32_t>(plan_.rooms.size());
    for (uint32_t i = 0; i < count; ++i) {
      for (uint32_t j = 0; j < count; ++j) {
        const BaseRoom& first = plan_.rooms[i];
        const BaseRoom& second = plan_.rooms[j];
        const Vec2 low = glm::max(first.low, second.low);
        const Vec2 high = glm::min(first.high, second.high);
        const bool beside = first.high.x == second.low.x && low.y < high.y;
        const bool behind = first.high.y == second.low.y && low.x < high.x;
        if (beside || behind) plan_.walls.push_back({{i, j}, low, high});
      }
    }
  }

  /// Doors connect all rooms, and a third of the other walls that are long enough have one.
  void add_doors() {
    std::vector<uint32_t> order;
    for (uint32_t i = 0; i < plan_.walls.size(); ++i) {
      if (glm::distance(plan_.walls[i].a, plan_.walls[i].b) >= BasePlan::kDoorWidth + 2 * kMargin) order.push_back(i);
    }
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return std::pair(number(spanning, a), a) < std::pair(number(spanning, b), b);
    });
    std::vector<uint32_t> part(plan_.rooms.size());  // rooms that doors connect have the same number
    std::iota(part.begin(), part.end(), 0u);
    for (const uint32_t i : order) {
      BaseWall& wall = plan_.walls[i];
      const uint32_t first = part[wall.rooms[0]];
      const uint32_t second = part[wall.rooms[1]];
      if (first == second && number(extra_door, i) % 3 != 0) continue;
      std::replace(part.begin(), part.end(), second, first);
      add_door(wall, i);
    }
  }

  void add_door(BaseWall& wall, uint32_t i) {
    const float length = glm::distance(wall.a, wall.b);
    const Vec2 along = (wall.b - wall.a) / length;
    const float free = length - BasePlan::kDoorWidth - 2 * kMargin;
    const Vec2 start = wall.a + (kMargin + free * random(door_position, i)) * along;
    const Vec2 end = start + BasePlan::kDoorWidth * along;
    BaseDoor door;
    door.along_x = wall.along_x();
    // Ahead is +z for walls along x, with smaller x to the left, and +x for the others, with larger z to the left.
    door.portal = {{wall.rooms[0], wall.rooms[1]}, door.along_x ? start : end, door.along_x ? end : start};
    wall.door = static_cast<int>(plan_.doors.size());
    plan_.doors.push_back(door);
  }

  /// The shortest way from the first room to one of the farthest rooms, by the number of doors, or its beginning.
  void find_walk() {
    constexpr uint32_t kUnknown = UINT32_MAX;
    std::vector<uint32_t> entered_by(plan_.rooms.size(), kUnknown);  // door
    std::deque<uint32_t> open{0};
    uint32_t last = 0;
    const auto behind = [&](uint32_t door, uint32_t room) {
      const Portal& portal = plan_.doors[door].portal;
      return portal.rooms[portal.rooms[0] == room ? 1 : 0];
    };
    while (!open.empty()) {
      last = open.front();
      open.pop_front();
      for (uint32_t d = 0; d < plan_.doors.size(); ++d) {
        const Portal& portal = plan_.doors[d].portal;
        if (portal.rooms[0] != last && portal.rooms[1] != last) continue;
        const uint32_t next = behind(d, last);
        if (next == 0 || entered_by[next] != kUnknown) continue;
        entered_by[next] = d;
        open.push_back(next);
      }
    }
    for (uint32_t room = last; room != 0; room = behind(entered_by[room], room)) {
      plan_.walk.insert(plan_.walk.begin(), room);
      plan_.walk_doors.insert(plan_.walk_doors.begin(), entered_by[room]);
    }
    plan_.walk.insert(plan_.walk.begin(), 0);
    if (plan_.walk.size() > kMostWalked) {
      plan_.walk.resize(kMostWalked);
      plan_.walk_doors.resize(kMostWalked - 1);
    }
    plan_.rooms[plan_.walk[plan_.walk.size() / 2]].lamps = BaseLamps::skylight;
  }

  /// Half of the doors have a leaf. On the walk, it is down from 0.6 s before the camera passes to 1.5 s after.
  void time_doors() {
    const float end_s = BasePlan::kWait_s + BasePlan::kStep_s * static_cast<float>(plan_.walk_doors.size());
    for (uint32_t i = 0; i < plan_.doors.size(); ++i) {
      BaseDoor& door = plan_.doors[i];
      door.has_leaf = number(leaf, i) % 2 == 0;
      door.opens_s = 0.5f + (end_s - 4) * random(opening, i);
      door.closes_s = door.opens_s + 2 + 3 * random(closing, i);
    }
    for (size_t k = 0; k < plan_.walk_doors.size(); ++k) {
      BaseDoor& door = plan_.doors[plan_.walk_doors[k]];
      const float passes_s = BasePlan::kWait_s + BasePlan::kStep_s * (static_cast<float>(k) + 0.5f);
      door.opens_s = passes_s - 1.6f;
      door.closes_s = passes_s + 1.5f;
    }
  }

  uint32_t seed_;
  BasePlan plan_;
};

}  // namespace

std::vector<Portal> BasePlan::portals() const {
  std::vector<Portal> list;
  for (const BaseDoor& door : doors) list.push_back(door.portal);
  return list;
}

BasePlan make_base_plan(uint32_t seed) { return Planner(seed).make(); }

}  // namespace relume
