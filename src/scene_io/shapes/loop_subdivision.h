// Loop's subdivision surfaces (C. Loop, "Smooth Subdivision Surfaces Based on Triangles", 1987).
#pragma once

#include <span>

#include "scene/scene.h"

namespace relume {

/// Largest number of triangles of a subdivided mesh; fewer levels keep to it.
inline constexpr size_t kMaxSubdivided = size_t{1} << 20;

/// Subdivides the cage `levels` times with Warren's weights, as pbrt does, moves the vertices to the limit
/// surface, and computes smooth normals. Edges with one or with more than two triangles are boundaries. Indices must be
/// in range.
Mesh loop_subdivided(std::span<const Vec3> positions, std::span<const UVec3> triangles, int levels);

}  // namespace relume
