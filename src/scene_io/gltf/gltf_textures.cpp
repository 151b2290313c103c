#include "scene_io/gltf/gltf_textures.h"

#include <exception>

#include <fmt/format.h>

#include "core/parallel.h"
#include "scene_io/gltf/gltf_extras.h"
#include "scene_io/gltf/gltf_value.h"
#include "scene_io/texture_decode.h"

namespace relume::gltf {
namespace {

WrapMode wrap_mode(int gl_name) {
  switch (gl_name) {
    case TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE: return WrapMode::clamp;
    case TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT: return WrapMode::mirror;
    default: return WrapMode::repeat;
  }
}

void apply_sampler(const tinygltf::Sampler& sampler, Texture& texture) {
  texture.wrap_u = wrap_mode(sampler.wrapS);
  texture.wrap_v = wrap_mode(sampler.wrapT);
  texture.filter = sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST ? FilterMode::nearest : FilterMode::linear;
}

/// Image of the texture: that of KHR_texture_basisu, or else its source. -1: it has none.
int image_of(const tinygltf::Texture& texture) {
  const auto basisu = texture.extensions.find("KHR_texture_basisu");
  if (basisu == texture.extensions.end()) return texture.source;
  return integer_member(basisu->second, "source", texture.source);
}

void make_stand_in(TextureUse use, Texture& texture) {
  const auto byte = [](int value) { return static_cast<std::byte>(value); };
  texture.width = 1;
  texture.height = 1;
  texture.texels = use == TextureUse::normal ? std::vector{byte(128), byte(128), byte(255), byte(255)}
                                             : std::vector{byte(255), byte(255), byte(255), byte(255)};
}

}  // namespace

Index TextureImporter::request(int texture, TextureUse use) {
  const auto& textures = document_.model.textures;
  if (texture < 0 || static_cast<size_t>(texture) >= textures.size()) {
    document_.warnings.add(
        fmt::format("a material refers to texture {}, which does not exist; it is ignored", texture));
    return kNone;
  }
  const int sampler = textures[static_cast<size_t>(texture)].sampler;
  const int image = image_of(textures[static_cast<size_t>(texture)]);
  const auto [entry, is_new] = known_.try_emplace({image, sampler, use}, static_cast<Index>(scene_.textures.size()));
  if (is_new) {
    Texture result;
    result.name = textures[static_cast<size_t>(texture)].name;
    result.format = use == TextureUse::color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear;
    if (sampler >= 0 && static_cast<size_t>(sampler) < document_.model.samplers.size())
      apply_sampler(document_.model.samplers[static_cast<size_t>(sampler)], result);
    scene_.textures.push_back(std::move(result));
    requests_.push_back({image, use, texture_image(textures[static_cast<size_t>(texture)].extras)});
  }
  return entry->second;
}

/// Returns what went wrong, nothing if nothing did. `repair`: what was mended.
std::string TextureImporter::decode(const Request& request, Texture& texture, std::string& repair) const {
  if (request.image < 0 || static_cast<size_t>(request.image) >= document_.images.size())
    return "a texture has no image in a supported format";
  const ImageEntry& image = document_.images[static_cast<size_t>(request.image)];
  std::string name = !image.name.empty() ? image.name : image.uri;
  if (name.empty() || is_data_uri(name)) name = fmt::format("image {}", request.image);
  try {
    Bytes storage;
    ByteSpan bytes;
    if (!request.float_image.empty()) {
      storage = read_file_bytes(resolve_uri(document_.base_dir, percent_decode(request.float_image), document_.place));
      bytes = storage;
    } else if (is_data_uri(image.uri)) {
      auto decoded = decode_data_uri(image.uri);
      if (!decoded) return fmt::format("the data URI of image {} is malformed", request.image);
      storage = std::move(*decoded);
      bytes = storage;
    } else if (!image.uri.empty()) {
      storage = read_file_bytes(resolve_uri(document_.base_dir, percent_decode(image.uri), document_.place));
      bytes = storage;
    } else if (image.buffer_view >= 0 && static_cast<size_t>(image.buffer_view) < document_.views.size()) {
      bytes = document_.views[static_cast<size_t>(image.buffer_view)];
    } else {
      return fmt::format("image {} has neither a URI nor a buffer view", request.image);
    }
    Texture decoded = decode_texture(bytes, name, texture.format);
    repair = repair_texels(decoded, name, texture.format);
    texture.width = decoded.width;
    texture.height = decoded.height;
    texture.format = decoded.format;
    texture.texels = std::move(decoded.texels);
    if (texture.name.empty()) texture.name = name;
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

void TextureImporter::decode_all() {
  std::vector<std::string> problems(requests_.size());
  std::vector<std::string> repairs(requests_.size());
  parallel_for(requests_.size(), [&](size_t i) {
    problems[i] = decode(requests_[i], scene_.textures[i], repairs[i]);
    if (!problems[i].empty()) make_stand_in(requests_[i].use, scene_.textures[i]);
  });
  for (const std::string& problem : problems) {
    if (!problem.empty())
      document_.warnings.add(fmt::format("{}; a stand-in of one texel replaces the texture", problem));
  }
  for (const std::string& repair : repairs) {
    if (!repair.empty()) document_.warnings.add(repair);
  }
}

}  // namespace relume::gltf
