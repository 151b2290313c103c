// Meshes, nodes, lights and cameras of a scene that assimp read.
#pragma once

#include "scene/scene.h"
#include "scene_io/warnings.h"

struct aiScene;

namespace relume {

/// Appends all triangle meshes to `scene`. Returns the index in Scene::meshes of each of the source's meshes, kNone for
/// those without triangles.
std::vector<Index> import_assimp_meshes(const aiScene& source, Scene& scene, Warnings& warnings);

/// Appends the node tree, whose nodes refer to `mesh_of`, and hangs lights and cameras into it.
void import_assimp_nodes(const aiScene& source, const std::vector<Index>& mesh_of, Scene& scene, Warnings& warnings);

}  // namespace relume
