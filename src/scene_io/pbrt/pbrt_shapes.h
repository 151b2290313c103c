// Meshes of pbrt's shapes.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene_io/pbrt/pbrt_description.h"

namespace relume::pbrt {

class ShapeReader {
 public:
  /// `base_dir`: folder of PLY files. Meshes are added to `scene`.
  ShapeReader(std::filesystem::path base_dir, Scene& scene, Warnings& warnings)
      : base_dir_(std::move(base_dir)), scene_(scene), warnings_(warnings) {}

  /// A shape's mesh, flipped if `reversed`, and under `baked` if that is no null pointer. Similar quadrics of the
  /// same `look_key` share a mesh. ShapeEntity::mesh is kNone, with a warning, for shapes that are not supported.
  /// Throws Error for missing or damaged data.
  ShapeEntity read(const std::string& kind, const Parameters& parameters, bool reversed, const Mat4* baked,
                   const std::string& look_key);

 private:
  Mesh triangles(const Parameters& parameters) const;
  Mesh ply(const Parameters& parameters);
  Mesh patches(const Parameters& parameters);
  Mesh subdivision(const Parameters& parameters) const;
  /// The mesh of a quadric of `radius`, for the radius 1: all sizes share it.
  Index quadric(const std::string& kind, const Parameters& parameters, bool reversed, const Mat4* baked,
                const std::string& look_key, float radius);
  /// Segments of the next quadric; 0 if there are too many.
  int segments() const;
  Index add(Mesh mesh, bool reversed, const Mat4* baked);

  std::filesystem::path base_dir_;
  Scene& scene_;
  Warnings& warnings_;
  std::map<std::string, Index> quadrics_;
  size_t made_ = 0;  ///< triangles of patches and subdivision surfaces so far
  size_t quadric_triangles_ = 0;
};

}  // namespace relume::pbrt
