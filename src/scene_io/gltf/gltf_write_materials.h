// Materials and textures of a scene into a glTF file.
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

  /// Writes all materials, in the scene's order, and the textures that they use.
  void write();

 private:
  /// glTF decides by use whether texels are sRGB colours or plain data.
  enum class Use : uint8_t { color, data };

  OutputJson material(const Material& m);
  OutputJson metallic_roughness(const Material& m);
  void add_parameters(const Material& m, OutputJson& extensions);
  /// Adds a texture info at `key` if `ref` names a texture.
  void add_texture(OutputJson& object, const char* key, const TextureRef& ref, Use use);
  /// Adds `members` to those that the extension has.
  void add_extension(OutputJson& extensions, const char* name, const OutputJson& members);

  /// Keeps the texture's file where that is untouched and of a format that glTF knows.
  int texture(Index index, Use use);
  /// The texels as a PNG, and beside it what a PNG cannot hold.
  void add_png(OutputJson& texture, const Texture& t, Use use, const std::string& name);
  int sampler(const Texture& t);
  /// `name`: the file's, without its extension, if it is one of its own.
  int image(const std::string& title, std::span<const std::byte> bytes, const ImageType& type, const std::string& name);

  const Scene& scene_;
  Output& output_;
  std::map<std::pair<Index, Use>, int> textures_;
  std::vector<const ImageType*> kept_types_;  ///< of the textures whose files are kept; nullptr: a PNG is made
  std::set<std::string> needed_;              ///< extensions without which images cannot be read
};

}  // namespace relume::gltf
