// Repairs meshes from files.
#pragma once

#include "scene/scene.h"
#include "scene_io/warnings.h"

namespace relume {

/// Repairs data that validate() and kernels do not accept, with warnings:
///
/// - Triangles with missing, non-finite or too distant vertices are dropped.
/// - Normals that are not finite or have zero length are recomputed from adjacent triangles.
/// - Broken tangents are dropped.
/// - Texture coordinates and colours that are not finite become 0 and 1.
///
/// Normals and tangents become unit vectors. Unused vertices are removed if triangles use less than half of them
/// (primitives that share one vertex buffer).
void repair_mesh(Mesh& mesh, Warnings& warnings);

/// Area-weighted vertex normals; vertices without a valid triangle get +Y.
std::vector<Vec3> smooth_normals(const Mesh& mesh);

}  // namespace relume
