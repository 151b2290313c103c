// Imports nodes, cameras and lights of a glTF file.
#pragma once

#include <vector>

#include "scene_io/gltf/gltf_keys.h"
#include "scene_io/gltf/gltf_meshes.h"
#include "scene_io/gltf/gltf_punctual.h"

namespace relume::gltf {

/// Imports the nodes of the default scene with their content. Without a default, the first scene is used; without
/// scenes, all nodes. Returns the index in Scene::nodes of each glTF node, kNone for nodes outside the scene. Throws
/// Error for cycles, nodes with two parents and missing children.
std::vector<Index> import_nodes(Document& document, Scene& scene, MeshImporter& meshes, PunctualImporter& punctual);

/// Imports the animation of nodes, materials, lights and cameras, with one clip per animation.
void import_animation(Document& document, const SceneIndices& indices, Scene& scene);

/// Removes channels of morph targets that no mesh of their node has. Call after reading the meshes.
void drop_missing_targets(Document& document, Scene& scene);

/// Removes clips without channels.
void drop_empty_clips(Scene& scene);

}  // namespace relume::gltf
