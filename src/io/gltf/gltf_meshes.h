// Meshes of a glTF file: each primitive becomes one Mesh.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "io/gltf/gltf_materials.h"

namespace relume::gltf {

class MeshImporter {
 public:
  MeshImporter(Document& document, Scene& scene, MaterialImporter& materials)
      : document_(document), scene_(scene), materials_(materials) {}

  /// Indices in Scene::meshes of the primitives of glTF mesh `mesh` (imported at its first use). Throws Error if there
  /// is no such mesh or if its data go beyond their buffers.
  const std::vector<Index>& import(int mesh);

 private:
  std::optional<Mesh> convert(const tinygltf::Primitive& primitive, const std::string& name);
  void count_vertices(size_t count);

  Document& document_;
  Scene& scene_;
  MaterialImporter& materials_;
  std::map<int, std::vector<Index>> known_;
  size_t vertices_read_ = 0;
};

/// Triangles of an index list by glTF's primitive mode (triangles, strip or fan); incomplete triangles are left out.
std::vector<UVec3> assemble_triangles(const std::vector<uint32_t>& indices, int mode);

}  // namespace relume::gltf
