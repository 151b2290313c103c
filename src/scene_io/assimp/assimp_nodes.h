// Converts meshes, nodes, lights and cameras of an assimp scene.
#pragma once

#include "scene/scene.h"
#include "scene_io/warnings.h"

struct aiScene;

namespace relume {

/// Appends all triangle meshes to `scene`. Returns, per source mesh, its index in Scene::meshes, or kNone if it has no
/// triangles.
std::vector<Index> import_assimp_meshes(const aiScene& source, Scene& scene, Warnings& warnings);

/// Appends the node tree with meshes from `mesh_of`, lights and cameras.
void import_assimp_nodes(const aiScene& source, const std::vector<Index>& mesh_of, Scene& scene, Warnings& warnings);

}  // namespace relume
