// Imports skins, joints and morph targets of a glTF file.
#pragma once

#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_primitive.h"

namespace relume::gltf {

/// Reads JOINTS_n and WEIGHTS_n of a primitive into `mesh`. The first set that does not fit its vertices and all later
/// ones are ignored with a warning.
void read_influences(const PrimitiveReader& reader, Mesh& mesh, Warnings& warnings);

/// Number of JOINTS_n sets of the primitive.
size_t joint_sets(const PrimitiveReader& reader);

/// Reads a primitive's morph target displacements into `mesh`. Attributes that do not fit its vertices are ignored with
/// a warning.
void read_morph_targets(const Document& document, const tinygltf::Primitive& primitive, Mesh& mesh, Warnings& warnings);

/// Names in `extras.targetNames` of a mesh; empty for entries that are not strings.
std::vector<std::string> morph_target_names(const tinygltf::Mesh& mesh);

/// Morph target weights of a node, or those of its mesh if it has none.
std::vector<float> default_morph_weights(const tinygltf::Model& model, const tinygltf::Node& node);

/// Imports the skins of nodes. Replaces Node::skin, an index in the file, by one in the scene, or by kNone for an
/// unusable skin. Throws Error for a missing skin.
void import_skins(Document& document, const std::vector<Index>& node_of, Scene& scene);

/// Removes skins, with a warning, from nodes whose meshes use joints that the skin lacks. Call after reading the
/// meshes.
void drop_unusable_skins(Document& document, Scene& scene);

}  // namespace relume::gltf
