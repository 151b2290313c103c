// Nodes, cameras and lights of a glTF file.
#pragma once

#include <vector>

#include "scene_io/gltf/gltf_keys.h"
#include "scene_io/gltf/gltf_meshes.h"
#include "scene_io/gltf/gltf_punctual.h"

namespace relume::gltf {

/// Imports the nodes of the default scene (the first one if the file names none, all nodes if it has no scenes) with
/// what they carry. Returns the index in Scene::nodes of each glTF node, kNone for those outside. Throws Error for
/// cyclic trees, nodes with two parents and children that do not exist.
std::vector<Index> import_nodes(Document& document, Scene& scene, MeshImporter& meshes, PunctualImporter& punctual);

/// Imports the animation of nodes, materials, lights and cameras, a clip for each animation of the file.
void import_animation(Document& document, const SceneIndices& indices, Scene& scene);

/// Once the meshes are read: takes out the channels of morph targets that no mesh of their node has.
void drop_missing_targets(Document& document, Scene& scene);

/// Takes out the clips that have no channels.
void drop_empty_clips(Scene& scene);

}  // namespace relume::gltf
