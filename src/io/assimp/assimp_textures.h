// Textures of a scene that assimp read. Its formats keep opacity, roughness and metalness in images of their own;
// Material wants them in the channels that glTF says, so images are combined here.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "io/warnings.h"
#include "scene/scene.h"

struct aiScene;

namespace relume {

/// How a texture is put together from up to two images.
enum class TextureRecipe {
  color,            ///< first: RGBA
  color_and_alpha,  ///< RGB of the first (white if empty), opacity of the second: its alpha if it has any, else its red
  roughness_metal,  ///< G = red of the first, B = red of the second; 255 where empty
  data,             ///< first: RGBA, linear
  normal,           ///< first, unless it is a height map
};

class AssimpTextures {
 public:
  AssimpTextures(const aiScene& source, std::filesystem::path base_dir, Scene& scene, Warnings& warnings)
      : source_(source), base_dir_(std::move(base_dir)), scene_(scene), warnings_(warnings) {}

  /// Index in Scene::textures of a texture made of the images at these paths ("*N": embedded image N; empty: none).
  Index request(TextureRecipe recipe, const std::string& first, const std::string& second, WrapMode wrap_u,
                WrapMode wrap_v);

  /// Decodes the images in parallel and puts the textures together. A missing or broken image counts as white (a flat
  /// normal), with a warning.
  void finish();

  /// After finish(): whether nothing but white stands in for the texture's image.
  bool is_missing(Index texture) const { return missing_[static_cast<size_t>(texture)]; }

  /// After finish(): whether some texel's alpha is below one half.
  bool has_transparency(Index texture) const;

 private:
  struct Request {
    TextureRecipe recipe;
    std::string first;
    std::string second;
  };

  void add_image(const std::string& path, PixelFormat format);
  Texture decode(const std::string& path, PixelFormat format) const;
  std::filesystem::path find_file(const std::string& path) const;
  const Texture* image(const std::string& path, PixelFormat format) const;
  void compose(const Request& request, Texture& texture, Warnings& warnings) const;

  const aiScene& source_;
  std::filesystem::path base_dir_;
  Scene& scene_;
  Warnings& warnings_;
  std::vector<Request> requests_;  ///< parallel to Scene::textures
  std::vector<bool> missing_;      ///< the same: the first image
  std::map<std::pair<std::string, PixelFormat>, Texture> images_;
};

}  // namespace relume
