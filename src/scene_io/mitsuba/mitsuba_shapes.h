// Shapes of Mitsuba scenes as nodes with meshes.
#pragma once

#include <set>

#include "files/bytes.h"
#include "scene_io/mitsuba/mitsuba_materials.h"

namespace relume::mitsuba {

class Shapes {
 public:
  Shapes(Import& import, Textures& textures);

  /// Adds a shape, or the shapes of a "merge". Shapes that are not supported, and those whose file is missing, are
  /// skipped with a warning. Throws Error for damaged files.
  void add(const Object& shape, Index parent);

  /// Adds the nodes of shape groups, with one instance per "instance" that add() met.
  void finish(Index parent);

 private:
  /// What a shape shows, in the scene.
  struct Placed {
    Index mesh = kNone;
    glm::dmat4 to_world{1};
  };

  std::optional<Placed> place(const Object& shape);
  void add_instance(const Object& instance);
  const Mesh* geometry(const Parameters& p, std::string* key);
  std::optional<Mesh> load(const Parameters& p, const std::filesystem::path& file);
  Mesh load_serialized(const Parameters& p, const std::string& place);
  glm::dmat4 own_transform(const Parameters& p);
  glm::dmat4 to_world_of(const Parameters& p);
  Index mesh_of(const Parameters& p, const Mesh& geometry, const std::string& key, const glm::dmat4& to_world);
  /// Adds a mesh's vertices and triangles to a count. Throws Error beyond the limit.
  void count_elements(const Mesh& mesh, uint64_t& count, uint64_t limit) const;

  Import& import_;
  Surfaces surfaces_;
  Materials materials_;
  Surface grey_;   ///< of shapes without BSDF
  Surface black_;  ///< of lamps without BSDF
  int segments_ = 96;
  std::map<std::string, std::optional<Mesh>> geometries_;  ///< by type, file and flags; std::nullopt: missing
  std::map<std::pair<std::string, Index>, Index> meshes_;  ///< by geometry and material
  std::map<const Object*, std::vector<Mat4>> instances_;   ///< by shape group
  std::string serialized_place_;
  Bytes serialized_;                            ///< of this file, which often has many meshes
  std::map<std::string, uint64_t> inflatable_;  ///< by file: bytes that may still be decompressed
  std::set<std::string> used_;                  ///< geometries with a mesh of the scene
  uint64_t elements_ = 0;                       ///< vertices and triangles of all geometries
  uint64_t copied_ = 0;                         ///< the same of their further meshes
  uint64_t shapes_ = 0;                         ///< outside groups
  uint64_t placed_ = 0;                         ///< instances of all groups
};

}  // namespace relume::mitsuba
