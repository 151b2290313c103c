// Textures of a scene that assimp read. Its formats keep opacity, roughness and metalness in images of their own;
// Material wants them in the channels that glTF says, so images are combined here.
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
  /// For `imported`, which must outlive this object. Image files are looked for from `base_dir`.
  AssimpTextures(ImportedScene& imported, std::filesystem::path base_dir, Warnings& warnings)
      : imported_(imported), base_dir_(std::move(base_dir)), warnings_(warnings) {}

  /// Decodes the images in parallel and puts the textures together in Scene::textures. A missing or broken image counts
  /// as white (a flat normal), with a warning.
  void finish();

  /// After finish(): materials that emit only by a texture, whose image is missing, are dark.
  void darken_missing_lamps() const;

  /// After finish(): materials whose colour texture has holes become alpha-masked, since these formats do not say how
  /// they mean their alpha channel.
  void mask_transparent_textures() const;

 private:
  using Images = std::map<std::pair<std::string, PixelFormat>, Texture>;

  void decode_images();
  Texture decode(const std::string& path, PixelFormat format) const;
  std::filesystem::path find_file(const std::string& path) const;
  const Texture* image(const std::string& path, PixelFormat format) const;
  void compose(const TextureRequest& request, Texture& texture, Warnings& warnings) const;
  bool has_transparency(Index texture) const;

  ImportedScene& imported_;
  std::filesystem::path base_dir_;
  Warnings& warnings_;
  Images images_;
  std::vector<bool> missing_;  ///< parallel to Scene::textures: the first image
};

}  // namespace relume
