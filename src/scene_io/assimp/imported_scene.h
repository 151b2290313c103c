// Result of the process that runs assimp: a scene whose images are not decoded.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "files/bytes.h"
#include "scene/scene.h"

namespace relume {

/// Composition of a texture from up to two images.
enum class TextureRecipe : uint8_t {
  color,            ///< RGBA of the first image
  color_and_alpha,  ///< RGB of the first (white if empty); opacity from the second's alpha if it has any, else its red
  roughness_metal,  ///< G = red of the first, B = red of the second; 255 where empty
  data,             ///< RGBA of the first image, linear
  normal,           ///< first image, unless it is a height map
};

/// A texture composed of the images at two paths; an empty path means none.
struct TextureRequest {
  TextureRecipe recipe = TextureRecipe::color;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  std::string first;
  std::string second;
};

/// An image stored in the scene file.
struct EmbeddedImage {
  int width = 0;   ///< in RGBA texels; 0: `bytes` holds an image file
  int height = 0;  ///< same
  Bytes bytes;
};

struct ImportedScene {
  std::string problem;                            ///< sentence for a file that cannot be read; empty on success
  Scene scene;                                    ///< without textures, animation and environment
  std::vector<TextureRequest> textures;           ///< future Scene::textures
  std::map<std::string, EmbeddedImage> embedded;  ///< keyed by the paths in `textures`
  std::vector<Index> texture_lamps;               ///< materials that emit only from their texture
  std::vector<std::string> files;                 ///< paths that assimp opened or looked for
};

Bytes serialise(const ImportedScene& imported);

/// Reverses serialise(). The bytes are untrusted: indices of textures and materials are checked here, the remainder by
/// validate(). Throws Error with `place`.
ImportedScene deserialise(std::span<const std::byte> bytes, const std::string& place);

}  // namespace relume
