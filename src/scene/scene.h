// Internal functions on scenes, beyond the public interface.
#pragma once

#include <string>
#include <vector>

#include "core/box.h"
#include "core/vec.h"
#include "relume/scene.h"

namespace relume {

/// Name of the scene at the start of error messages; "scene" if it has none.
inline std::string error_place(const Scene& scene) { return scene.name.empty() ? "scene" : scene.name; }

/// All texture references of a material, used or not.
std::vector<const TextureRef*> texture_refs(const Material& material);

/// validate() for one part of a scene before its replacement.
void validate(const Material& material, const std::string& place);
void validate(const PunctualLight& light, const std::string& place);
void validate(const Camera& camera, const std::string& place);
void validate(const Environment& environment, const std::string& place);

/// Calls f(mesh, to_node) for every placement of a node's meshes: once per instance, or once with the identity.
template <typename F>
void for_each_place(const Node& node, const F& f) {
  for (const Index mesh : node.meshes) {
    if (node.instances.empty()) f(mesh, Mat4(1));
    for (const Mat4& to_node : node.instances) f(mesh, to_node);
  }
}

/// Bounds of each mesh in mesh space.
std::vector<Box> mesh_boxes(const Scene& scene);

/// Throws Error (invalid_handle) unless `index` is valid among `count` parts of this kind ("node"). `place` begins the
/// message.
void check_index(Index index, size_t count, const char* kind, const std::string& place);

/// Whether each node may move: the node or an ancestor has an animation channel or is in `movable`.
/// Throws Error (invalid_handle) if `movable` lists a node that does not exist.
std::vector<bool> moving_nodes(const Scene& scene, const std::vector<Index>& movable = {});

/// Whether each node is visible at `time_s`: neither the node nor an ancestor is hidden.
std::vector<bool> visible_nodes(const Scene& scene, float time_s);

/// Whether each node is visible at any time.
std::vector<bool> ever_visible_nodes(const Scene& scene);

/// Weights of a node's morph targets at `time_s`; missing weights are 0.
std::vector<float> morph_weights(const Scene& scene, Index node, float time_s);

}  // namespace relume
