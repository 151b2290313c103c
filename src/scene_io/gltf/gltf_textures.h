// Textures of a glTF file: one for each image, sampler and pixel format in use.
#pragma once

#include <map>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// What a texture is for; decides its pixel format, and its value if it cannot be read.
enum class TextureUse { color, data, normal };

/// Name of one of the document's images, for messages.
std::string image_name(const Document& document, int image);
/// Bytes of an image as they are stored. Throws Error for images that do not exist or cannot be read.
Bytes read_image_file(const Document& document, int image);

class TextureImporter {
 public:
  TextureImporter(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// Index in Scene::textures of glTF texture `texture`, kNone (with a warning) if the file has no such texture. Its
  /// texels come with decode_all().
  Index request(int texture, TextureUse use);

  /// Decodes what was requested, in parallel. A missing or broken image becomes one texel of a constant value,
  /// with a warning.
  void decode_all();

 private:
  struct Request {
    std::vector<int> images;  ///< in the order of preference
    TextureUse use = TextureUse::color;
    std::string float_image;  ///< URI of what replaces the image; empty: nothing
    float glossiness = -1;    ///< texture_glossiness()
  };

  /// The first image that can be read, or one texel of a constant value.
  void decode(const Request& request, Texture& texture, Warnings& warnings) const;
  /// Throws Error or another exception for what cannot be read.
  void decode(const Request& request, int image, Texture& texture, Warnings& warnings) const;

  Document& document_;
  Scene& scene_;
  std::map<std::tuple<std::vector<int>, int, TextureUse, float>, Index> known_;  ///< images, sampler, use, glossiness
  std::vector<Request> requests_;                                                ///< parallel to Scene::textures
};

}  // namespace relume::gltf
