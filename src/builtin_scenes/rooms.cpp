#include "builtin_scenes/rooms.h"

#include <cmath>

#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

/// Joins build(row, column) over all open cells.
template <typename Build>
Mesh for_open_cells(const FloorPlan& plan, Build build) {
  Mesh mesh;
  for (int row = 0; row < static_cast<int>(plan.rows.size()); ++row) {
    for (int column = 0; column < static_cast<int>(plan.rows[static_cast<size_t>(row)].size()); ++column) {
      if (plan.open(row, column)) append(mesh, build(row, column));
    }
  }
  return mesh;
}

}  // namespace

Mesh wall(const Vec2& a, const Vec2& b, float thickness, float height, const std::vector<Opening>& openings) {
  constexpr float kSunk = -0.01f;
  const float length = glm::distance(a, b);
  Mesh mesh;
  const auto piece = [&](float from, float to, float bottom, float top) {
    if (to > from && top > bottom) append(mesh, box({from, bottom, -thickness / 2}, {to, top, thickness / 2}));
  };
  float done = 0;
  for (const Opening& opening : openings) {
    piece(done, opening.along.x, kSunk, height);
    piece(opening.along.x, opening.along.y, kSunk, opening.height.x);
    piece(opening.along.x, opening.along.y, opening.height.y, height);
    done = opening.along.y;
  }
  piece(done, length, kSunk, height);
  const float turn_deg = glm::degrees(std::atan2(a.y - b.y, b.x - a.x));
  return transformed(std::move(mesh), translation({a.x, 0, a.y}) * rotation_y(turn_deg));
}

Mesh room(const Vec3& low, const Vec3& high) { return flipped(box(low, high)); }

bool FloorPlan::open(int row, int column) const {
  if (row < 0 || row >= static_cast<int>(rows.size())) return false;
  const std::string_view cells = rows[static_cast<size_t>(row)];
  return column >= 0 && column < static_cast<int>(cells.size()) && cells[static_cast<size_t>(column)] != '#';
}

Vec3 FloorPlan::middle(int row, int column, float y) const {
  return {(static_cast<float>(column) + 0.5f) * cell, y, (static_cast<float>(row) + 0.5f) * cell};
}

Mesh plan_floor(const FloorPlan& plan) {
  const float c = plan.cell;
  return for_open_cells(plan, [&](int row, int column) {
    return quad(plan.middle(row, column, 0) + Vec3(-c, 0, c) * 0.5f, {c, 0, 0}, {0, 0, -c});
  });
}

Mesh plan_ceiling(const FloorPlan& plan) {
  const float c = plan.cell;
  return for_open_cells(plan, [&](int row, int column) {
    return quad(plan.middle(row, column, plan.height) - Vec3(c, 0, c) * 0.5f, {c, 0, 0}, {0, 0, c});
  });
}

Mesh plan_walls(const FloorPlan& plan, char mark) {
  constexpr int kStepRow[4] = {-1, 0, 1, 0};
  constexpr int kStepColumn[4] = {0, 1, 0, -1};
  return for_open_cells(plan, [&](int row, int column) {
    Mesh sides;
    if (plan.rows[static_cast<size_t>(row)][static_cast<size_t>(column)] != mark) return sides;
    for (int i = 0; i < 4; ++i) {
      if (plan.open(row + kStepRow[i], column + kStepColumn[i])) continue;
      const Vec3 outward(kStepColumn[i], 0, kStepRow[i]);
      const Vec3 along = glm::cross(outward, Vec3(0, 1, 0)) * plan.cell;  // along × up looks back into the cell
      const Vec3 corner = plan.middle(row, column, 0) + outward * (plan.cell / 2) - along * 0.5f;
      append(sides, quad(corner, along, {0, plan.height, 0}));
    }
    return sides;
  });
}

}  // namespace relume
