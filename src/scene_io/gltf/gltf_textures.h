// Imports glTF textures: one per image, sampler and pixel format in use.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_document.h"

namespace relume::gltf {

/// Use of a texture. Selects the pixel format, and the value of an unreadable image.
enum class TextureUse { color, data, normal };

/// Name of a document's image for messages.
std::string image_name(const Document& document, int image);
/// Stored bytes of an image. Throws Error for missing or unreadable images.
Bytes read_image_file(const Document& document, int image);

class TextureImporter {
 public:
  TextureImporter(Document& document, Scene& scene) : document_(document), scene_(scene) {}

  /// Index in Scene::textures of glTF texture `texture`; kNone with a warning if it is missing. decode_all() fills its
  /// texels.
  Index request(int texture, TextureUse use);

  /// Decodes requested textures in parallel within a DecodeBudget. A missing or broken image becomes one texel of a
  /// constant value, with a warning.
  void decode_all();

 private:
  struct Request {
    std::vector<int> images;  ///< in order of preference
    TextureUse use = TextureUse::color;
    std::string float_image;  ///< URI of the image's replacement; empty: none
    float glossiness = -1;    ///< texture_glossiness()
  };

  /// An undecoded image.
  struct ImageFile {
    std::shared_ptr<const Bytes> bytes;  ///< nullptr if unreadable
    std::string problem;                 ///< reason
    uint64_t texels = 0;                 ///< from its header; 0: unknown
  };

  ImageFile read(const Request& request, int image) const;
  /// Drops images beyond a DecodeBudget in request order, independently of threads.
  void limit(std::vector<std::vector<ImageFile>>& files) const;
  /// Decodes the first readable image, else makes one texel of a constant value. `files` holds the request's images.
  void decode(const Request& request, std::span<const ImageFile> files, Texture& texture, Warnings& warnings) const;
  /// Throws Error or another exception if decoding fails.
  void decode(const Request& request, const ImageFile& file, const std::string& name, Texture& texture,
              Warnings& warnings) const;

  Document& document_;
  Scene& scene_;
  std::map<std::tuple<std::vector<int>, int, TextureUse, float>, Index> known_;  ///< images, sampler, use, glossiness
  std::vector<Request> requests_;                                                ///< parallel to Scene::textures
};

}  // namespace relume::gltf
