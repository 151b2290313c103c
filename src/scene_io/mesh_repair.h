// Repairs meshes from files.
#pragma once

#include "scene/scene.h"
#include "scene_io/warnings.h"

namespace relume {

/// Repairs data that validate() and kernels reject, with warnings. Drops triangles with missing, non-finite or too
/// distant vertices, and all tangents if one is broken. Recomputes normals that are not finite or have zero length from
/// adjacent triangles. Non-finite texture coordinates become 0, colours 1; normals and tangents become unit vectors. If
/// triangles use less than half of the vertices (primitives that share one buffer), the others are removed.
void repair_mesh(Mesh& mesh, Warnings& warnings);

/// Area-weighted vertex normals; vertices without a valid triangle get +Y.
std::vector<Vec3> smooth_normals(const Mesh& mesh);

}  // namespace relume
