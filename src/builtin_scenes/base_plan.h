// Floor plan of the base: rooms by binary space partition, doors, and a walk.
#pragma once

#include <cstdint>
#include <vector>

#include "builtin_scenes/portals.h"

namespace relume {

enum class BaseLamps : uint32_t { strips, panels, screens, dim, skylight };

/// A rectangle of the plan (x, z). Its edges are whole metres.
struct BaseRoom {
  Vec2 low;
  Vec2 high;
  BaseLamps lamps = BaseLamps::strips;

  Vec2 middle() const { return 0.5f * (low + high); }
};

/// The common side of two rooms, from a to b.
struct BaseWall {
  uint32_t rooms[2];  ///< the first one has the smaller coordinates
  Vec2 a;
  Vec2 b;
  int door = -1;  ///< index in BasePlan::doors; -1: none

  bool along_x() const { return a.y == b.y; }
};

/// An opening. A leaf that sinks into the floor within a second may close it.
struct BaseDoor {
  Portal portal;
  bool along_x = true;
  bool has_leaf = false;
  float opens_s = 0;   ///< the leaf begins to sink
  float closes_s = 0;  ///< the leaf begins to rise

  Vec2 middle() const { return 0.5f * (portal.left + portal.right); }
};

struct BasePlan {
  static constexpr float kWidth = 48;  ///< metres, along x
  static constexpr float kDepth = 40;
  static constexpr float kDoorWidth = 1.2f;
  static constexpr float kStep_s = 2.5f;  ///< of the walk, from room to room
  static constexpr float kWait_s = 1;     ///< before the walk begins

  std::vector<BaseRoom> rooms;
  std::vector<BaseWall> walls;
  std::vector<BaseDoor> doors;
  std::vector<uint32_t> walk;        ///< rooms in their order
  std::vector<uint32_t> walk_doors;  ///< between them

  std::vector<Portal> portals() const;
};

/// The plan of a seed: 40 to 60 rooms with sides of at least 3 m, connected by doors.
BasePlan make_base_plan(uint32_t seed);

}  // namespace relume
