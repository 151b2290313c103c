// What the process that runs assimp hands over: a scene whose images are not decoded yet.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "files/bytes.h"
#include "scene/scene.h"

namespace relume {

/// How a texture is put together from up to two images.
enum class TextureRecipe : uint8_t {
  color,            ///< first: RGBA
  color_and_alpha,  ///< RGB of the first (white if empty), opacity of the second: its alpha if it has any, else its red
  roughness_metal,  ///< G = red of the first, B = red of the second; 255 where empty
  data,             ///< first: RGBA, linear
  normal,           ///< first, unless it is a height map
};

/// A texture made of the images at two paths; empty: none.
struct TextureRequest {
  TextureRecipe recipe = TextureRecipe::color;
  WrapMode wrap_u = WrapMode::repeat;
  WrapMode wrap_v = WrapMode::repeat;
  std::string first;
  std::string second;
};

/// An image inside the scene file.
struct EmbeddedImage {
  int width = 0;   ///< of RGBA texels; 0: `bytes` is an image file
  int height = 0;  ///< likewise
  Bytes bytes;
};

struct ImportedScene {
  std::string problem;                            ///< why the file cannot be read, a sentence; empty: it can
  Scene scene;                                    ///< without textures, animation and environment
  std::vector<TextureRequest> textures;           ///< to become Scene::textures
  std::map<std::string, EmbeddedImage> embedded;  ///< by their paths in `textures`
  std::vector<Index> texture_lamps;               ///< materials that emit only by their texture
};

Bytes serialise(const ImportedScene& imported);

/// The reverse. The bytes are not trusted: indices of textures and materials are in range afterwards, everything else
/// is checked by validate(). Throws Error with `place`.
ImportedScene deserialise(std::span<const std::byte> bytes, const std::string& place);

}  // namespace relume
