// Imports glTF meshes: each primitive becomes one Mesh.
#pragma once

#include <atomic>
#include <map>
#include <vector>

#include "scene_io/gltf/gltf_materials.h"

namespace relume::gltf {

class MeshImporter {
 public:
  MeshImporter(Document& document, Scene& scene, MaterialImporter& materials)
      : document_(document), scene_(scene), materials_(materials) {}

  /// Indices in Scene::meshes of the primitives of glTF mesh `mesh`, which finish() reads. Throws Error for a missing
  /// mesh.
  const std::vector<Index>& import(int mesh);

  /// Reads all requested primitives in parallel and removes those without triangles. Throws Error if data exceed their
  /// buffers.
  void finish();

 private:
  void convert(const tinygltf::Primitive& primitive, Mesh& mesh, Warnings& warnings);
  void count_vertices(size_t count);
  void count_deformation(size_t bytes);
  void warn_of_lost_anisotropy();
  void name_morph_targets();
  void leave_out_empty_meshes();

  Document& document_;
  Scene& scene_;
  MaterialImporter& materials_;
  std::map<int, std::vector<Index>> known_;
  std::vector<const tinygltf::Primitive*> requests_;  ///< parallel to Scene::meshes
  std::atomic<size_t> vertices_read_ = 0;
  std::atomic<size_t> deformation_bytes_ = 0;
  size_t skipped_primitives_ = 0;  ///< points and lines
};

/// Triangles of an index list by glTF's primitive mode (triangles, strip or fan), without incomplete triangles.
std::vector<UVec3> assemble_triangles(const std::vector<uint32_t>& indices, int mode);

}  // namespace relume::gltf
