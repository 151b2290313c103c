// Skins, joints and morph targets of a glTF file.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_primitive.h"

namespace relume::gltf {

/// JOINTS_n and WEIGHTS_n of a primitive, into `mesh`. Sets that do not fit its vertices are ignored, with a warning.
void read_influences(const PrimitiveReader& reader, Mesh& mesh, Warnings& warnings);

/// Sets of JOINTS_n that the primitive has.
size_t joint_sets(const PrimitiveReader& reader);

/// Displacements of a primitive's morph targets, into `mesh`. Attributes that do not fit its vertices are ignored, with
/// a warning.
void read_morph_targets(const Document& document, const tinygltf::Primitive& primitive, Mesh& mesh, Warnings& warnings);

/// The names in `extras.targetNames` of a mesh; what has no name is left empty.
std::vector<std::string> morph_target_names(const tinygltf::Mesh& mesh);

/// Weights of the morph targets of a node: its own, else those of its mesh.
std::vector<float> default_morph_weights(const tinygltf::Model& model, const tinygltf::Node& node);

/// Imports the skins that nodes refer to: Node::skin is the file's number before and the scene's afterwards, or kNone
/// for a skin that cannot be used. Throws Error for a skin that does not exist.
void import_skins(Document& document, const std::vector<Index>& node_of, Scene& scene);

/// Once the meshes are read: nodes whose meshes follow joints that their skin lacks lose it, with a warning.
void drop_unusable_skins(Document& document, Scene& scene);

}  // namespace relume::gltf
