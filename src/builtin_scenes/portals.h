// Visibility between convex rooms through openings in their common walls.
#pragma once

#include <cstdint>
#include <vector>

#include "core/vec.h"

namespace relume {

/// An opening from the floor to a height that all portals share, in the floor plan (x, z).
struct Portal {
  uint32_t rooms[2];
  Vec2 left;  ///< end on the left of the way from rooms[0] to rooms[1], where z lies to the left of x
  Vec2 right;
};

/// For each room the rooms of which it sees a point, itself included, in ascending order [Teller91]. Exact for
/// convex rooms and thin walls: a line crosses a sequence of portals if it has all left ends on its left, and all right
/// ends on its right. Thick walls and furniture see less. All portals are open.
std::vector<std::vector<uint32_t>> visible_rooms(uint32_t room_count, const std::vector<Portal>& portals);

}  // namespace relume
