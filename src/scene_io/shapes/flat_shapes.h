// Meshes of rectangles and bilinear patches.
#pragma once

#include <array>
#include <span>

#include "scene/scene.h"

namespace relume {

/// Square [-1, 1]² in the plane z = 0 that faces +Z; texture coordinates (u, 1 - v) with u along +X and v along +Y.
Mesh rectangle_mesh();

/// Corners of bilinear patches, four indices for each: at (u, v) = (0, 0), (1, 0), (0, 1), (1, 1).
struct BilinearPatches {
  std::span<const Vec3> positions;
  std::span<const Vec3> normals;  ///< one per position; empty: of the patch, ∂u × ∂v
  std::span<const Vec2> uv;       ///< one per position, v upwards; empty: the patch's own
  std::span<const std::array<uint32_t, 4>> patches;
};

/// Cells of a patch that is not flat, in each direction.
inline constexpr int kPatchCells = 16;

/// One mesh of all patches, whose front faces ∂u × ∂v. A patch whose corners form a parallelogram becomes two
/// triangles, others `cells`² times two. Indices must be in range.
Mesh bilinear_mesh(const BilinearPatches& patches, int cells = kPatchCells);

}  // namespace relume
