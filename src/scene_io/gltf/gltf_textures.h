// Textures of a glTF file: one for each image, sampler and pixel format in use.
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

  /// Decodes what was requested, in parallel, within a DecodeBudget. A missing or broken image becomes one texel of a
  /// constant value, with a warning.
  void decode_all();

 private:
  struct Request {
    std::vector<int> images;  ///< in the order of preference
    TextureUse use = TextureUse::color;
    std::string float_image;  ///< URI of what replaces the image; empty: nothing
    float glossiness = -1;    ///< texture_glossiness()
  };

  /// An image before it is decoded.
  struct ImageFile {
    std::shared_ptr<const Bytes> bytes;  ///< nullptr: it cannot be read
    std::string problem;                 ///< why not
    uint64_t texels = 0;                 ///< according to its header; 0: not known
  };

  ImageFile read(const Request& request, int image) const;
  /// Drops images that exceed a DecodeBudget, in the order of the requests: which ones does not depend on threads.
  void limit(std::vector<std::vector<ImageFile>>& files) const;
  /// The first image that can be decoded, or one texel of a constant value. `files`: of the request's images.
  void decode(const Request& request, std::span<const ImageFile> files, Texture& texture, Warnings& warnings) const;
  /// Throws Error or another exception for what cannot be decoded.
  void decode(const Request& request, const ImageFile& file, const std::string& name, Texture& texture,
              Warnings& warnings) const;

  Document& document_;
  Scene& scene_;
  std::map<std::tuple<std::vector<int>, int, TextureUse, float>, Index> known_;  ///< images, sampler, use, glossiness
  std::vector<Request> requests_;                                                ///< parallel to Scene::textures
};

}  // namespace relume::gltf
