// Nodes of a scene, and what hangs on them, into a glTF file.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_output.h"

namespace relume::gltf {

class NodeWriter {
 public:
  NodeWriter(const Scene& scene, Output& output) : scene_(scene), output_(output) {}

  /// Writes meshes, cameras, lights, skins and nodes. glTF node i is node i of the scene. Returns the indices of
  /// the nodes without parent.
  std::vector<int> write();

 private:
  void write_cameras();
  void write_lights();
  void write_variants();
  OutputJson node(size_t index, bool animated);
  void add_transform(OutputJson& json, const Node& node, bool animated);
  /// The node's mesh, once or as instances.
  void add_meshes(OutputJson& json, const Node& node);
  int mesh(const std::vector<Index>& parts, const std::string& name);
  OutputJson primitive(const Mesh& m);
  void add_instances(OutputJson& json, const std::vector<Transform>& instances);
  void write_skins();
  /// Morph targets that the meshes of a node have at most.
  size_t target_count(std::span<const Index> meshes) const;
  void add_morph_weights(OutputJson& json, const Node& node);
  /// Accessor of displacements that are all zero.
  int no_displacements(size_t vertices);
  void add_morph_targets(OutputJson& json, const Mesh& m);
  void add_influences(OutputJson& attributes, const Mesh& m);
  const Scene& scene_;
  Output& output_;
  std::vector<bool> hides_;                                ///< by node: an animation hides or shows it
  std::map<std::vector<Index>, int> meshes_;               ///< by the meshes of a node
  std::map<Index, OutputJson> primitives_;                 ///< by mesh; accessors are shared
  std::vector<std::pair<Index, OutputJson>> extra_nodes_;  ///< parent and node: instances that need a node each
};

}  // namespace relume::gltf
