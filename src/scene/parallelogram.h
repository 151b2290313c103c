// Parallelograms of two triangles, as quadrilaterals are usually stored.
#pragma once

#include <optional>

#include "scene/scene_view.h"

namespace relume {

/// Corner and sides of a parallelogram as vertices of its first triangle, in the order of that triangle.
struct Parallelogram {
  uint32_t corner;      ///< opposite to the diagonal that the triangles share
  uint32_t first_end;   ///< of the first side
  uint32_t second_end;  ///< of the second side
  float deviation;      ///< distance of the fourth vertex from its place, in the units of the vertices
};

/// The parallelogram that triangles `a` and `b` form; std::nullopt if they do not, or are degenerate.
std::optional<Parallelogram> find_parallelogram(View<const Vertex> vertices, const UVec3& a, const UVec3& b);

/// Whether all triangles 2k and 2k + 1 of the mesh form parallelograms.
bool consists_of_parallelograms(const SceneView& geometry, const MeshView& mesh);

}  // namespace relume
