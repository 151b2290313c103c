// Makes meshes from files fit for use.
#pragma once

#include "scene/scene.h"
#include "scene_io/warnings.h"

namespace relume {

/// Repairs what validate() and kernels cannot bear, and says so in `warnings`:
/// triangles that refer to missing vertices or to vertices that are not finite are dropped; normals that are not finite
/// or have no length are computed anew from the adjacent triangles; broken tangents are dropped; texture coordinates
/// and colours that are not finite become 0 and 1. Normals and tangents become unit vectors. If triangles use less than
/// half of the vertices (primitives that share one vertex buffer), the others are removed.
void repair_mesh(Mesh& mesh, Warnings& warnings);

/// Area-weighted vertex normals; vertices without a proper triangle get +Y.
std::vector<Vec3> smooth_normals(const Mesh& mesh);

}  // namespace relume
