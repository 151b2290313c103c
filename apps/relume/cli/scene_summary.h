// Scene summary of `relume info`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace relume::cli {

struct SceneSummary {
  size_t nodes = 0;
  size_t meshes = 0;
  size_t materials = 0;
  size_t textures = 0;
  size_t lights = 0;  ///< punctual
  size_t emissive_materials = 0;
  size_t mesh_instances = 0;
  uint64_t triangles = 0;            ///< stored
  uint64_t instanced_triangles = 0;  ///< counted per instance
  std::vector<std::string> cameras;
  std::vector<std::string> variants;  ///< of materials
  float animation_s = 0;              ///< end of the longest animation
  std::vector<std::string> clips;     ///< names of the animations
  /// World bounds at time 0, from the transformed boxes of the meshes: conservative. min > max: no mesh is placed.
  Vec3 bounds_min{kInfinity};
  Vec3 bounds_max{-kInfinity};
  uint64_t geometry_bytes = 0;
  uint64_t texture_bytes = 0;  ///< including the environment map
  std::string environment;     ///< "none", "constant 1, 1, 1", "map 1024 x 512", "sun and sky"
  std::vector<std::string> warnings;
  std::vector<std::filesystem::path> files;  ///< files that warnings may name
};

SceneSummary summarize(const Scene& scene);

/// Lines of "name: value".
std::string to_text(const SceneSummary& summary);

}  // namespace relume::cli
