// Writes a scene's nodes and their content to a glTF file.
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

  /// Writes meshes, cameras, lights, skins and nodes. glTF node i is node i of the scene. Returns the root nodes.
  std::vector<int> write();

 private:
  void write_cameras();
  void write_lights();
  void write_variants();
  OutputJson node(size_t index, bool animated);
  void add_transform(OutputJson& json, const Node& node, bool animated);
  /// Adds the node's mesh, once or as instances.
  void add_meshes(OutputJson& json, const Node& node);
  int mesh(const std::vector<Index>& parts, const std::string& name);
  OutputJson primitive(const Mesh& m);
  void add_instances(OutputJson& json, const std::vector<Transform>& instances);
  void write_skins();
  /// Largest number of morph targets among these meshes.
  size_t target_count(std::span<const Index> meshes) const;
  void add_morph_weights(OutputJson& json, const Node& node);
  /// Accessor of zero displacements.
  int no_displacements(size_t vertices);
  void add_morph_targets(OutputJson& json, const Mesh& m);
  void add_influences(OutputJson& attributes, const Mesh& m);
  const Scene& scene_;
  Output& output_;
  std::vector<bool> hides_;                                ///< per node: has animated visibility
  std::map<std::vector<Index>, int> meshes_;               ///< keyed by a node's meshes
  std::map<Index, OutputJson> primitives_;                 ///< per mesh; accessors are shared
  std::vector<std::pair<Index, OutputJson>> extra_nodes_;  ///< parent and node: instances that need separate nodes
};

}  // namespace relume::gltf
