// Writes a scene's materials and textures to a glTF file.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "scene_io/gltf/gltf_output.h"

namespace relume::gltf {

struct ImageType;

class MaterialWriter {
 public:
  MaterialWriter(const Scene& scene, Output& output) : scene_(scene), output_(output) {}

  /// Writes all materials in scene order, and the textures that they use.
  void write();

 private:
  /// Use of texels: glTF derives sRGB or linear encoding from it.
  enum class Use : uint8_t { color, data };

  OutputJson material(const Material& m);
  OutputJson metallic_roughness(const Material& m);
  void add_parameters(const Material& m, OutputJson& extensions);
  /// Adds a texture info at `key` if `ref` has a texture.
  void add_texture(OutputJson& object, const char* key, const TextureRef& ref, Use use);
  /// Merges `members` into the extension.
  void add_extension(OutputJson& extensions, const char* name, const OutputJson& members);

  /// Adds a texture. Keeps its original file if the texels are unchanged and glTF supports the format.
  int texture(Index index, Use use);
  /// Adds the texels as a PNG, plus an EXR file if they are floats.
  void add_png(OutputJson& texture, const Texture& t, Use use, const std::string& name);
  int sampler(const Texture& t);
  /// `name` is the file name without extension, for an image in a separate file.
  int image(const std::string& title, std::span<const std::byte> bytes, const ImageType& type, const std::string& name);

  const Scene& scene_;
  Output& output_;
  std::map<std::pair<Index, Use>, int> textures_;
  std::vector<const ImageType*> kept_types_;  ///< types of textures with kept files; nullptr: a PNG is written
  std::set<std::string> needed_;              ///< extensions required to read images
  bool has_mixtures_ = false;
};

}  // namespace relume::gltf
