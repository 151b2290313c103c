#include "scene_io/gltf/gltf_textures.h"

#include <algorithm>
#include <cstring>
#include <exception>

#include <fmt/format.h>

#include "core/activity.h"
#include "core/parallel.h"
#include "core/srgb.h"
#include "core/vec.h"
#include "image/image_size.h"
#include "relume/image_io.h"
#include "scene_io/gltf/gltf_extras.h"
#include "scene_io/gltf/gltf_value.h"
#include "scene_io/image_search.h"
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

/// Images of the texture by priority: those of extensions, then the source that they replace. The first readable one is
/// used.
std::vector<int> images_of(const tinygltf::Texture& texture) {
  std::vector<int> images;
  for (const char* name : {"KHR_texture_basisu", "EXT_texture_webp"}) {
    const auto extension = texture.extensions.find(name);
    if (extension == texture.extensions.end()) continue;
    if (const int image = integer_member(extension->second, "source", -1); image >= 0) images.push_back(image);
  }
  if (texture.source >= 0) images.push_back(texture.source);
  return images;
}

void make_constant(TextureUse use, Texture& texture) {
  const auto byte = [](int value) { return static_cast<std::byte>(value); };
  texture.width = 1;
  texture.height = 1;
  texture.texels = use == TextureUse::normal ? std::vector{byte(128), byte(128), byte(255), byte(255)}
                                             : std::vector{byte(255), byte(255), byte(255), byte(255)};
}

/// Stores roughness in G, 1 − glossiness · alpha, and metallic 0 in B.
void make_roughness(float glossiness, Texture& texture) {
  if (texture.format == PixelFormat::rgba32_float) {
    for (size_t i = 0; i + sizeof(Vec4) <= texture.texels.size(); i += sizeof(Vec4)) {
      Vec4 texel;
      std::memcpy(&texel, &texture.texels[i], sizeof texel);
      texel = {0, 1.0f - glossiness * saturate(texel.w), 0, 1};
      std::memcpy(&texture.texels[i], &texel, sizeof texel);
    }
    return;
  }
  for (size_t i = 0; i + 3 < texture.texels.size(); i += 4) {
    const float alpha = static_cast<float>(texture.texels[i + 3]) / 255.0f;
    texture.texels[i + 1] = std::byte{quantise_unorm8(1.0f - glossiness * alpha)};
    texture.texels[i] = texture.texels[i + 2] = std::byte{0};
    texture.texels[i + 3] = std::byte{255};
  }
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
  const std::vector<int> images = images_of(textures[static_cast<size_t>(texture)]);
  const float glossiness = texture_glossiness(textures[static_cast<size_t>(texture)].extras);
  const auto [entry, is_new] =
      known_.try_emplace({images, sampler, use, glossiness}, static_cast<Index>(scene_.textures.size()));
  if (is_new) {
    Texture result;
    result.name = textures[static_cast<size_t>(texture)].name;
    result.format = use == TextureUse::color ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear;
    if (sampler >= 0 && static_cast<size_t>(sampler) < document_.model.samplers.size())
      apply_sampler(document_.model.samplers[static_cast<size_t>(sampler)], result);
    scene_.textures.push_back(std::move(result));
    requests_.push_back({images, use, texture_image(textures[static_cast<size_t>(texture)].extras), glossiness});
  }
  return entry->second;
}

std::string image_name(const Document& document, int image) {
  if (image < 0 || static_cast<size_t>(image) >= document.images.size()) return fmt::format("image {}", image);
  const ImageEntry& entry = document.images[static_cast<size_t>(image)];
  std::string name = !entry.name.empty() ? entry.name : entry.uri;
  if (name.empty() || is_data_uri(name)) name = fmt::format("image {}", image);
  return name;
}

Bytes read_image_file(const Document& document, int image) {
  if (image < 0 || static_cast<size_t>(image) >= document.images.size())
    throw Error(fmt::format("there is no image {}", image));
  const ImageEntry& entry = document.images[static_cast<size_t>(image)];
  if (is_data_uri(entry.uri)) {
    auto decoded = decode_data_uri(entry.uri);
    if (!decoded) throw Error(fmt::format("the data URI of image {} is malformed", image));
    return std::move(*decoded);
  }
  if (!entry.uri.empty())
    return read_file_bytes(find_image(document.base_dir, percent_decode(entry.uri), document.place));
  if (entry.buffer_view < 0 || static_cast<size_t>(entry.buffer_view) >= document.views.size())
    throw Error(fmt::format("image {} has neither a URI nor a buffer view", image));
  const auto view = static_cast<size_t>(entry.buffer_view);
  if (const std::string problem = view_problem(document, view); !problem.empty())
    throw Error(fmt::format("{}: {}; export or copy the file again", image_name(document, image), problem));
  return {document.views[view].begin(), document.views[view].end()};
}

TextureImporter::ImageFile TextureImporter::read(const Request& request, int image) const {
  ImageFile file;
  try {
    file.bytes = std::make_shared<const Bytes>(
        request.float_image.empty()
            ? read_image_file(document_, image)
            : read_file_bytes(find_image(document_.base_dir, percent_decode(request.float_image), document_.place)));
  } catch (const std::exception& error) {
    file.problem = error.what();
    return file;
  }
  try {
    const detail::ImageSize size = detail::read_image_size(*file.bytes, image_name(document_, image));
    const bool is_valid = std::min(size.width, size.height) > 0 && std::max(size.width, size.height) <= kMaxImageSide;
    if (is_valid) file.texels = static_cast<uint64_t>(size.width * size.height);
  } catch (const std::exception&) {
    file.texels = 0;  // decoding reports the problem
  }
  return file;
}

void TextureImporter::decode(const Request& request, const ImageFile& file, const std::string& name, Texture& texture,
                             Warnings& warnings) const {
  if (!file.bytes) throw Error(file.problem);
  Texture decoded = decode_texture(*file.bytes, name, texture.format);
  if (const std::string repair = repair_texels(decoded, name, texture.format); !repair.empty()) warnings.add(repair);
  const bool is_changed = request.glossiness >= 0;
  if (is_changed) make_roughness(request.glossiness, decoded);
  texture.width = decoded.width;
  texture.height = decoded.height;
  texture.format = decoded.format;
  texture.texels = std::move(decoded.texels);
  texture.file = is_changed ? nullptr : file.bytes;
  if (texture.name.empty()) texture.name = name;
}

void TextureImporter::decode(const Request& request, std::span<const ImageFile> files, Texture& texture,
                             Warnings& warnings) const {
  std::string problem = "a texture has no image in a supported format";
  for (size_t i = 0; i < files.size(); ++i) {
    try {
      const std::string name = files[i].bytes ? image_name(document_, request.images[i]) : "";
      decode(request, files[i], name, texture, warnings);
      if (i > 0) warnings.add(fmt::format("{}; the texture's other image, {}, is used", problem, name));
      return;
    } catch (const std::exception& error) {
      problem = error.what();
    }
  }
  warnings.add(fmt::format("{}; one texel of a constant value replaces the texture", problem));
  make_constant(request.use, texture);
}

void TextureImporter::limit(std::vector<std::vector<ImageFile>>& files) const {
  DecodeBudget budget;
  for (size_t i = 0; i < files.size(); ++i) {
    for (size_t k = 0; k < files[i].size(); ++k) {
      ImageFile& file = files[i][k];
      if (!file.bytes || budget.take(file.texels, file.bytes->size())) continue;
      file.problem = fmt::format(
          "{}: {} texels exceed the limit for the images of a scene, 2^29 texels and {} per byte of their files; scale "
          "it down",
          image_name(document_, requests_[i].images[k]), file.texels, DecodeBudget::kTexelsPerByte);
      file.bytes = nullptr;
    }
  }
}

void TextureImporter::decode_all() {
  Activity activity("decoding textures", requests_.size());
  std::vector<std::vector<ImageFile>> files(requests_.size());
  parallel_for(requests_.size(), [&](size_t i) {
    for (const int image : requests_[i].images) files[i].push_back(read(requests_[i], image));
  });
  limit(files);
  std::vector<Warnings> warnings(requests_.size(), Warnings(""));
  parallel_for(requests_.size(), [&](size_t i) {
    decode(requests_[i], files[i], scene_.textures[i], warnings[i]);
    activity.part_done();
  });
  for (const Warnings& part : warnings) document_.warnings.add(part);
}

}  // namespace relume::gltf
