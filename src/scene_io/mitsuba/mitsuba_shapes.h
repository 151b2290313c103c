// Shapes of Mitsuba scenes as nodes with meshes.
#pragma once

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
  glm::dmat4 own_transform(const Parameters& p);
  Index mesh_of(const Parameters& p, const Mesh& geometry, const std::string& key, const glm::dmat4& to_world);
  void check_size(const Mesh& mesh);

  Import& import_;
  Textures& textures_;
  Surfaces surfaces_;
  Materials materials_;
  Surface grey_;   ///< of shapes without BSDF
  Surface black_;  ///< of lamps without BSDF
  int segments_ = 96;
  std::map<std::string, std::optional<Mesh>> geometries_;  ///< by type, file and flags; std::nullopt: missing
  std::map<std::pair<std::string, Index>, Index> meshes_;  ///< by geometry and material
  std::map<const Object*, std::vector<Mat4>> instances_;   ///< by shape group
  uint64_t elements_ = 0;                                  ///< vertices and triangles of all meshes
  uint64_t placed_ = 0;                                    ///< instances of all groups
};

}  // namespace relume::mitsuba
