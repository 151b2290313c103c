// What the library asks of a scene beyond its public interface.
#pragma once

#include <string>
#include <vector>

#include "core/box.h"
#include "core/vec.h"
#include "relume/scene.h"

namespace relume {

/// All uses of textures that a material makes or could make.
std::vector<const TextureRef*> texture_refs(const Material& material);

/// The same for one part of a scene that is about to be replaced.
void validate(const Material& material, const std::string& place);
void validate(const PunctualLight& light, const std::string& place);
void validate(const Camera& camera, const std::string& place);
void validate(const Environment& environment, const std::string& place);

/// Calls f(mesh, to_node) for every place of a node's meshes: once for each instance, or once with the identity.
template <typename F>
void for_each_place(const Node& node, const F& f) {
  for (const Index mesh : node.meshes) {
    if (node.instances.empty()) f(mesh, Mat4(1));
    for (const Mat4& to_node : node.instances) f(mesh, to_node);
  }
}

/// About each mesh, in its own space.
std::vector<Box> mesh_boxes(const Scene& scene);

/// Whether each node may move: it or an ancestor has an animation channel or is one of `movable`.
std::vector<bool> moving_nodes(const Scene& scene, const std::vector<Index>& movable = {});

/// Whether each node is shown at `time_s`: neither it nor an ancestor is hidden.
std::vector<bool> visible_nodes(const Scene& scene, float time_s);

/// Whether each node is shown at some time.
std::vector<bool> ever_visible_nodes(const Scene& scene);

/// Weights of a node's morph targets at `time_s`; those that are missing are 0.
std::vector<float> morph_weights(const Scene& scene, Index node, float time_s);

}  // namespace relume
