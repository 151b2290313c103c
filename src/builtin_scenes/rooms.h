// Parts of buildings: walls with openings, and floor plans written as characters.
#pragma once

#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

/// A hole in a wall: ranges along the wall from its start and of heights, metres.
struct Opening {
  Vec2 along;
  Vec2 height;
};

/// Vertical wall of `thickness` centred on the line from a to b (x and z), from 1 cm below the floor to `height`.
/// Openings must be sorted along the wall and must not overlap.
Mesh wall(const Vec2& a, const Vec2& b, float thickness, float height, const std::vector<Opening>& openings = {});

/// The six inner faces of an axis-aligned box.
Mesh room(const Vec3& low, const Vec3& high);

/// A plan of square cells: row r, column c covers x in [c, c + 1] · cell and z in [r, r + 1] · cell. '#' is solid, all
/// other characters are open.
struct FloorPlan {
  std::vector<std::string_view> rows;
  float cell = 1;    ///< metres
  float height = 3;  ///< metres

  bool open(int row, int column) const;
  /// Middle of a cell at height y.
  Vec3 middle(int row, int column, float y) const;
};

Mesh plan_floor(const FloorPlan& plan);
Mesh plan_ceiling(const FloorPlan& plan);
/// Walls of the open cells marked with `mark`.
Mesh plan_walls(const FloorPlan& plan, char mark);

}  // namespace relume
