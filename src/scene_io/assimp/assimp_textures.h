// Textures of an assimp scene. Its formats store opacity, roughness and metalness in separate images. These are
// combined into glTF's channel layout for Material.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene_io/assimp/imported_scene.h"
#include "scene_io/warnings.h"

namespace relume {

class AssimpTextures {
 public:
  /// Reads image files relative to `base_dir`. `imported` must outlive this object.
  AssimpTextures(ImportedScene& imported, std::filesystem::path base_dir, Warnings& warnings)
      : imported_(imported), base_dir_(std::move(base_dir)), warnings_(warnings) {}

  /// Decodes the images in parallel and combines them in Scene::textures. A missing or broken image is replaced by
  /// white (or a flat normal), with a warning.
  void finish();

  /// Sets emission to 0 if it comes only from a texture whose image is missing. Call after finish().
  void darken_missing_lamps() const;

  /// Makes materials alpha-masked if their colour texture has holes: these formats do not specify the use of alpha.
  /// Call after finish().
  void mask_transparent_textures() const;

 private:
  using Images = std::map<std::pair<std::string, PixelFormat>, Texture>;

  void decode_images();
  Texture decode(const std::string& path, PixelFormat format) const;
  const Texture* image(const std::string& path, PixelFormat format) const;
  void compose(const TextureRequest& request, Texture& texture, Warnings& warnings) const;
  bool has_transparency(Index texture) const;

  ImportedScene& imported_;
  std::filesystem::path base_dir_;
  Warnings& warnings_;
  Images images_;
  std::vector<bool> missing_;  ///< per Scene::textures: whether the first image is missing
};

}  // namespace relume
