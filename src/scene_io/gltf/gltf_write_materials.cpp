#include "scene_io/gltf/gltf_write_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <stb_image_write.h>

#include "core/parallel.h"
#include "core/srgb.h"
#include "files/atomic_file.h"
#include "image/stb_decode.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "scene/material_parameters.h"
#include "scene_io/texture_decode.h"

namespace relume::gltf {

/// glTF's names of an image format.
struct ImageType {
  detail::ImageFormat format;
  const char* mime_type;
  const char* file_extension;
  const char* gltf_extension;  ///< required by such an image as a texture's source; nullptr: none
};

namespace {

/// 8-bit texels with RGB mapped by `curve`; alpha is unchanged.
template <typename Curve>
std::vector<std::byte> mapped(const std::vector<std::byte>& texels, Curve curve) {
  std::array<std::byte, 256> table;
  for (size_t i = 0; i < 256; ++i) table[i] = std::byte{quantise_unorm8(curve(static_cast<float>(i) / 255))};
  std::vector<std::byte> result(texels.size());
  for (size_t i = 0; i < texels.size(); ++i) result[i] = i % 4 == 3 ? texels[i] : table[static_cast<size_t>(texels[i])];
  return result;
}

std::vector<float> float_texels(const Texture& texture) {
  std::vector<float> values(texture.texels.size() / sizeof(float));
  std::copy_n(texture.texels.data(), texture.texels.size(), std::as_writable_bytes(std::span(values)).data());
  return values;
}

/// Four channels of a 32-bit float texture.
ExrFile exr_of(const Texture& texture) {
  const std::vector<float> values = float_texels(texture);
  ExrFile exr;
  exr.width = texture.width;
  exr.height = texture.height;
  for (size_t c = 0; c < 4; ++c) {
    ExrChannel channel;
    channel.name = std::string(1, "RGBA"[c]);
    for (size_t i = c; i < values.size(); i += 4) channel.values.push_back(values[i]);
    exr.channels.push_back(std::move(channel));
  }
  return exr;
}

/// 8-bit RGBA texels for the given use.
std::vector<std::byte> png_texels(const Texture& texture, bool color) {
  switch (texture.format) {
    case PixelFormat::rgba8_srgb:
      return color ? texture.texels : mapped(texture.texels, [](float x) { return linear_from_srgb(x); });
    case PixelFormat::rgba8_linear:
      return color ? mapped(texture.texels, [](float x) { return srgb_from_linear(x); }) : texture.texels;
    case PixelFormat::rgba32_float: break;
  }
  std::vector<std::byte> result;
  const std::vector<float> values = float_texels(texture);
  for (size_t i = 0; i < values.size(); ++i) {
    result.push_back(std::byte{quantise_unorm8(color && i % 4 != 3 ? srgb_from_linear(values[i]) : values[i])});
  }
  return result;
}

std::string png_file(int width, int height, const std::vector<std::byte>& texels) {
  std::string bytes;
  const auto write = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<size_t>(size));
  };
  stbi_write_png_to_func(write, &bytes, width, height, 4, texels.data(), 4 * width);
  return bytes;
}

constexpr ImageType kImageTypes[] = {
    {detail::ImageFormat::png, "image/png", ".png", nullptr},
    {detail::ImageFormat::jpeg, "image/jpeg", ".jpg", nullptr},
    {detail::ImageFormat::ktx2, "image/ktx2", ".ktx2", "KHR_texture_basisu"},
    {detail::ImageFormat::webp, "image/webp", ".webp", "EXT_texture_webp"},
};
constexpr const ImageType& kPng = kImageTypes[0];

/// Whether the texels are sRGB-encoded, as glTF requires for colour.
bool is_color(const Texture& t) { return t.format == PixelFormat::rgba8_srgb; }

/// Type of the texture's file if glTF supports it and the texels are unchanged; otherwise nullptr.
const ImageType* kept_type(const Texture& t) {
  if (!t.file) return nullptr;
  try {
    const detail::ImageFormat format = detail::detect_image_format(*t.file, t.name);
    const auto* const end = std::end(kImageTypes);
    const auto* const type =
        std::find_if(std::begin(kImageTypes), end, [&](const ImageType& known) { return known.format == format; });
    if (type == end) return nullptr;
    const Texture read =
        decode_texture(*t.file, t.name, is_color(t) ? PixelFormat::rgba8_srgb : PixelFormat::rgba8_linear);
    const bool same = read.width == t.width && read.height == t.height && read.format == t.format;
    return same && read.texels == t.texels ? type : nullptr;
  } catch (const Error&) {
    return nullptr;  // unreadable: the texture was given another file
  }
}

}  // namespace

void MaterialWriter::write() {
  kept_types_.resize(scene_.textures.size());
  parallel_for(kept_types_.size(), [&](size_t i) { kept_types_[i] = kept_type(scene_.textures[i]); });
  for (const Material& m : scene_.materials) output_.add("materials", material(m));
  if (has_mixtures_)
    output_.warn(
        "glTF has no mixtures of materials; relume reads them from extras, and other programs show approximations");
  if (!needed_.empty())
    output_.warn(
        fmt::format("textures keep their WebP or KTX2 images and have no PNG or JPEG beside them; other programs need "
                    "{} to open it",
                    fmt::join(needed_, " and ")));
}

OutputJson MaterialWriter::material(const Material& m) {
  OutputJson json = OutputJson::object();
  if (!m.name.empty()) json["name"] = m.name;
  json["pbrMetallicRoughness"] = metallic_roughness(m);
  add_texture(json, "normalTexture", m.normal_texture, Use::data);
  if (m.normal_texture.used() && m.normal_scale != 1) json["normalTexture"]["scale"] = number(m.normal_scale);
  const float strength = std::fmax(1.0f, max_component(m.emission));
  if (!is_black(m.emission)) json["emissiveFactor"] = numbers(m.emission / strength);
  add_texture(json, "emissiveTexture", m.emission_texture, Use::color);
  if (m.alpha_mode != AlphaMode::opaque) json["alphaMode"] = m.alpha_mode == AlphaMode::mask ? "MASK" : "BLEND";
  if (m.alpha_mode == AlphaMode::mask && m.alpha_cutoff != 0.5f) json["alphaCutoff"] = number(m.alpha_cutoff);
  if (m.double_sided) json["doubleSided"] = true;

  OutputJson extensions;
  if (strength > 1)
    add_extension(extensions, "KHR_materials_emissive_strength", {{"emissiveStrength", number(strength)}});
  if (m.unlit) add_extension(extensions, "KHR_materials_unlit", OutputJson::object());
  add_parameters(m, extensions);
  if (!extensions.is_null()) json["extensions"] = std::move(extensions);
  if (m.microfacet_model == MicrofacetModel::beckmann) json["extras"]["relume"]["microfacet_model"] = "beckmann";
  if (m.cull_back_faces == m.double_sided) json["extras"]["relume"]["cull_back_faces"] = m.cull_back_faces;
  if (m.mix_first != kNone) {
    OutputJson mix = {{"first", m.mix_first}, {"second", m.mix_second}, {"share", number(m.mix_share)}};
    add_texture(mix, "texture", m.mix_texture, Use::data);
    json["extras"]["relume"]["mix"] = std::move(mix);
    has_mixtures_ = true;
  }
  return json;
}

OutputJson MaterialWriter::metallic_roughness(const Material& m) {
  if (max_component(m.base_color) > 1)
    output_.warn(fmt::format("material '{}': its base colour exceeds 1, which other programs may clamp", m.name));
  OutputJson json = OutputJson::object();
  if (m.base_color != Rgb(1) || m.alpha != 1) {
    json["baseColorFactor"] = numbers(m.base_color);
    json["baseColorFactor"].push_back(number(m.alpha));
  }
  add_texture(json, "baseColorTexture", m.base_color_texture, Use::color);
  if (m.metallic != 1) json["metallicFactor"] = number(m.metallic);
  if (m.roughness != 1) json["roughnessFactor"] = number(m.roughness);
  add_texture(json, "metallicRoughnessTexture", m.metallic_roughness_texture, Use::data);
  return json;
}

/// Writes extension parameters that differ from their defaults.
void MaterialWriter::add_parameters(const Material& m, OutputJson& extensions) {
  const Material defaults;
  for_each_parameter(m, [&](const MaterialParameter& p, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if (!p.gltf.extension) return;
    OutputJson members = OutputJson::object();
    if constexpr (std::is_same_v<T, TextureRef>) {
      add_texture(members, p.gltf.key, value, p.color_texture ? Use::color : Use::data);
      if (p.texture_scale && value.used() && m.*p.texture_scale != 1)
        members[p.gltf.key]["scale"] = number(m.*p.texture_scale);
    } else if (const T& fallback = defaults.*std::get<T Material::*>(p.member); value != fallback) {
      if constexpr (std::is_same_v<T, float>) members[p.gltf.key] = number(value);
      if constexpr (std::is_same_v<T, Rgb>) members[p.gltf.key] = numbers(value);
    }
    if (!members.empty()) add_extension(extensions, p.gltf.extension, std::move(members));
  });
}

void MaterialWriter::add_extension(OutputJson& extensions, const char* name, const OutputJson& members) {
  OutputJson& extension = extensions[name];
  if (extension.is_null()) extension = OutputJson::object();
  extension.update(members);
  output_.use_extension(name);
}

void MaterialWriter::add_texture(OutputJson& object, const char* key, const TextureRef& ref, Use use) {
  if (!ref.used()) return;
  OutputJson info = {{"index", texture(ref.texture, use)}};
  if (ref.uv_set != 0) info["texCoord"] = ref.uv_set;
  OutputJson transform = OutputJson::object();
  if (ref.offset != Vec2(0)) transform["offset"] = numbers(ref.offset);
  if (ref.rotation_rad != 0) transform["rotation"] = number(ref.rotation_rad);
  if (ref.scale != Vec2(1)) transform["scale"] = numbers(ref.scale);
  if (!transform.empty()) add_extension(info["extensions"], "KHR_texture_transform", transform);
  object[key] = std::move(info);
}

int MaterialWriter::texture(Index index, Use use) {
  const auto [entry, is_new] = textures_.try_emplace({index, use}, 0);
  if (!is_new) return entry->second;
  const Texture& t = scene_.textures[static_cast<size_t>(index)];
  const std::string name = fmt::format("texture{}{}", index, use == Use::color ? "" : ".data");
  OutputJson json = OutputJson::object();
  if (!t.name.empty()) json["name"] = t.name;
  json["sampler"] = sampler(t);
  const ImageType* const type = kept_types_[static_cast<size_t>(index)];
  if (type && is_color(t) == (use == Use::color)) {
    const int kept = image(t.name, std::as_bytes(std::span(*t.file)), *type, name);
    if (type->gltf_extension) {
      json["extensions"][type->gltf_extension]["source"] = kept;
      output_.use_extension(type->gltf_extension, true);
      needed_.insert(type->gltf_extension);
    } else {
      json["source"] = kept;
    }
  } else {
    add_png(json, t, use, name);
  }
  entry->second = output_.add("textures", std::move(json));
  return entry->second;
}

void MaterialWriter::add_png(OutputJson& json, const Texture& t, Use use, const std::string& name) {
  const std::string png = png_file(t.width, t.height, png_texels(t, use == Use::color));
  json["source"] = image(t.name, std::as_bytes(std::span(png)), kPng, name);
  if (t.format == PixelFormat::rgba32_float) {
    const std::string exr =
        output_.add_file(name + ".exr", [&](const std::filesystem::path& file) { write_exr(file, exr_of(t)); });
    json["extras"]["relume"]["image"] = uri_of(exr);
    output_.warn(fmt::format(
        "texture '{}' has floating-point texels; they are kept in {}, and other programs see a PNG limited to [0, 1]",
        t.name, exr));
  } else if (is_color(t) != (use == Use::color)) {
    const bool to_srgb = use == Use::color;
    output_.warn(fmt::format("texture '{}' has {} texels, but glTF requires {} for this use; its texels are converted",
                             t.name, to_srgb ? "linear" : "sRGB", to_srgb ? "sRGB" : "linear ones"));
  }
}

int MaterialWriter::sampler(const Texture& t) {
  const auto wrap = [](WrapMode mode) {
    return mode == WrapMode::repeat ? 10497 : (mode == WrapMode::clamp ? 33071 : 33648);
  };
  const bool nearest = t.filter == FilterMode::nearest;
  const OutputJson json = {{"magFilter", nearest ? 9728 : 9729},
                           {"minFilter", nearest ? 9728 : 9987},  // linear with linear mip levels
                           {"wrapS", wrap(t.wrap_u)},
                           {"wrapT", wrap(t.wrap_v)}};
  const OutputJson& known = output_.list("samplers");
  for (size_t i = 0; i < known.size(); ++i) {
    if (known[i] == json) return static_cast<int>(i);
  }
  return output_.add("samplers", json);
}

int MaterialWriter::image(const std::string& title, std::span<const std::byte> bytes, const ImageType& type,
                          const std::string& name) {
  OutputJson json = OutputJson::object();
  if (!title.empty()) json["name"] = title;
  if (output_.binary()) {
    json["mimeType"] = type.mime_type;
    json["bufferView"] = output_.add_bytes(bytes);
  } else {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    json["uri"] = uri_of(output_.add_file(name + type.file_extension,
                                          [&](const std::filesystem::path& file) { write_file(file, text); }));
  }
  return output_.add("images", std::move(json));
}

}  // namespace relume::gltf
