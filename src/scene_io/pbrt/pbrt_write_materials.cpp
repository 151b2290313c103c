#include "scene_io/pbrt/pbrt_write_materials.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/exponential.hpp>

#include "core/srgb.h"
#include "core/vec.h"
#include "relume/image_io.h"
#include "scene_io/coated_albedo.h"
#include "scene_io/pbrt/pbrt_surface.h"

namespace relume::pbrt {
namespace {

/// Linear values of texel `i`.
Vec4 texel_at(const Texture& t, size_t i) {
  Vec4 texel;
  if (t.format == PixelFormat::rgba32_float) {
    std::memcpy(&texel, &t.texels[i * sizeof texel], sizeof texel);
    return texel;
  }
  for (size_t c = 0; c < 4; ++c) {
    const float code = static_cast<float>(std::to_integer<int>(t.texels[4 * i + c])) / 255.0f;
    texel[static_cast<int>(c)] = t.format == PixelFormat::rgba8_srgb && c < 3 ? linear_from_srgb(code) : code;
  }
  return texel;
}

size_t texel_count(const Texture& t) { return static_cast<size_t>(t.width) * static_cast<size_t>(t.height); }

Rgb in_range(const Rgb& color) { return glm::clamp(color, Rgb(0), Rgb(1)); }

constexpr std::string_view kMix = "\"string type\" \"mix\"";
constexpr float kCoatIndex = 1.5f;  // of clearcoats

/// Index of a coat with the reflectance at normal incidence of the material's.
float coat_index(const Material& m) {
  const float tint = glm::dot(m.specular_color, Rgb(0.2126f, 0.7152f, 0.0722f));
  const float f0 = std::min(sqr((m.ior - 1) / (m.ior + 1)) * tint, 1.0f) * m.specular;
  const float root = std::min(std::sqrt(f0), 0.95f);
  return (1 + root) / (1 - root);
}

bool is_transparent(const Material& m) {
  return m.transmission > 0 && (m.metallic < 1 || m.metallic_roughness_texture.used());
}

}  // namespace

std::vector<WrittenMaterial> MaterialWriter::write() {
  written_.resize(scene_.materials.size());
  for (size_t i = 0; i < scene_.materials.size(); ++i) write_after_parts(i);
  const bool needs_default =
      std::any_of(scene_.meshes.begin(), scene_.meshes.end(), [](const Mesh& mesh) { return mesh.material == kNone; });
  written_.push_back(needs_default ? material(Material{}, scene_.materials.size()) : WrittenMaterial{});
  return std::move(written_);
}

/// pbrt reads the parts of a mixture before it.
void MaterialWriter::write_after_parts(size_t index) {
  const Material& m = scene_.materials[index];
  if (!written_[index].name.empty()) return;
  for (const Index part : {m.mix_first, m.mix_second}) {
    if (part != kNone) write_after_parts(static_cast<size_t>(part));
  }
  written_[index] = material(m, index);
}

WrittenMaterial MaterialWriter::material(const Material& m, size_t index) {
  name_ = fmt::format("{} {}", m.name.empty() ? "material" : m.name, index);
  note_parts(m);
  WrittenMaterial written;
  written.area_light = area_light(m);
  written.has_emission_map = (m.unlit ? m.base_color_texture : m.emission_texture).used();
  written.alpha = alpha(m);
  written.medium = medium_of(m);
  normal_map_ = normal_map(m);
  written.name = define("", body(m));
  return written;
}

/// The medium of a material, or of the first part of a mixture that has one.
std::string MaterialWriter::medium_of(const Material& m) {
  if (m.mix_first == kNone) return medium(m);
  const std::string& first = written_[static_cast<size_t>(m.mix_first)].medium;
  const std::string& second = written_[static_cast<size_t>(m.mix_second)].medium;
  if (!first.empty() && !second.empty() && first != second)
    output_.note(fmt::format("material '{}': a shape has one medium, so that of the second part is left out", m.name));
  return first.empty() ? second : first;
}

std::string MaterialWriter::define(const std::string& part, const std::string& parameters) {
  const std::string name = in_quotes(part.empty() ? name_ : name_ + "." + part);
  const bool is_mix = parameters.starts_with(kMix);  // pbrt reads the normal maps of its parts
  output_.line(fmt::format("MakeNamedMaterial {} {}{}", name, parameters, is_mix ? "" : normal_map_));
  return name;
}

std::string MaterialWriter::body(const Material& m) {
  if (m.unlit) return "\"string type\" \"diffuse\" \"rgb reflectance\" [ 0 0 0 ]";
  if (m.mix_first != kNone) {
    return mixture(written_[static_cast<size_t>(m.mix_first)].name, written_[static_cast<size_t>(m.mix_second)].name,
                   m.mix_texture, [&](const Vec4& t) { return m.mix_share * t.x; });
  }
  const bool is_mixed = m.metallic > 0 && (m.metallic < 1 || m.metallic_roughness_texture.used());
  if (is_mixed) {
    return mixture(define("dielectric", dielectric(m)), define("metal", metal(m)), m.metallic_roughness_texture,
                   [&](const Vec4& t) { return m.metallic * t.z; });
  }
  return m.metallic > 0 ? metal(m) : dielectric(m);
}

std::string MaterialWriter::dielectric(const Material& m) {
  const auto opaque = [&] { return m.diffuse_transmission > 0 ? transmitting(m) : plastic(m); };
  if (!is_transparent(m)) return opaque();
  if (m.transmission >= 1 && !m.transmission_texture.used()) return glass(m);
  return mixture(define("opaque", opaque()), define("glass", glass(m)), m.transmission_texture,
                 [&](const Vec4& t) { return m.transmission * t.x; });
}

std::string MaterialWriter::mixture(const std::string& first, const std::string& second, const TextureRef& ref,
                                    const std::function<float(const Vec4&)>& amount) {
  return fmt::format("{} \"string materials\" [ {} {} ]", kMix, first, second) + value("amount", ref, amount);
}

std::string MaterialWriter::glass(const Material& m) {
  if (!(m.thickness > 0))
    return fmt::format("\"string type\" \"thindielectric\" \"float eta\" {}", number(index_of_thin_wall(m.ior)));
  std::string eta = "\"float eta\" " + number(m.ior);
  if (m.dispersion > 0) {
    // Cauchy's formula with two terms (docs/materials.md).
    eta = "\"spectrum eta\" [ ";
    for (int nm = 380; nm <= 780; nm += 20) {
      const auto wavelength = static_cast<float>(nm);
      const float index = m.ior + (m.ior - 1) * m.dispersion / 20 * (523655 / sqr(wavelength) - 1.5168f);
      eta += fmt::format("{} {} ", nm, number(index));
    }
    eta += "]";
  }
  return "\"string type\" \"dielectric\" " + eta + roughness(m, "");
}

std::string MaterialWriter::metal(const Material& m) {
  const bool is_coated = m.clearcoat >= 0.5f;
  const auto reflectance = color("reflectance", m.base_color_texture, [&](const Vec4& t) {
    const Rgb own = in_range(m.base_color * Rgb(t));
    return is_coated ? reflectance_without_coat(own, kCoatIndex) : own;
  });
  if (!is_coated) return "\"string type\" \"conductor\"" + reflectance + roughness(m, "");
  const float coat = sqr(m.clearcoat_roughness);
  return "\"string type\" \"coatedconductor\" \"bool remaproughness\" false \"float interface.roughness\" " +
         number(coat) + reflectance + roughness(m, "conductor.");
}

std::string MaterialWriter::plastic(const Material& m) {
  const float eta = coat_index(m);
  if (!(eta > 1.001f)) {
    return "\"string type\" \"diffuse\"" +
           color("reflectance", m.base_color_texture, [&](const Vec4& t) { return m.base_color * Rgb(t); });
  }
  const float inner = inner_reflectance(eta);
  return "\"string type\" \"coateddiffuse\" \"float eta\" " + number(eta) +
         color("reflectance", m.base_color_texture,
               [&](const Vec4& t) { return albedo_without_coat(in_range(m.base_color * Rgb(t)), inner); }) +
         roughness(m, "");
}

std::string MaterialWriter::transmitting(const Material& m) {
  const float share = m.diffuse_transmission;
  return "\"string type\" \"diffusetransmission\"" +
         color("reflectance", m.base_color_texture,
               [&](const Vec4& t) { return m.base_color * Rgb(t) * (1 - share); }) +
         color("transmittance", m.diffuse_transmission_color_texture,
               [&](const Vec4& t) { return m.diffuse_transmission_color * Rgb(t) * share; });
}

std::string MaterialWriter::roughness(const Material& m, const std::string& prefix) {
  std::string text = prefix.empty() ? " \"bool remaproughness\" false" : "";
  if (m.anisotropy > 0) {
    const float narrow = sqr(m.roughness);
    const float wide = lerp(narrow, 1.0f, sqr(m.anisotropy));
    const bool along_v = std::fabs(std::sin(m.anisotropy_rotation_rad)) > 0.70711f;
    return text + fmt::format(" \"float {}uroughness\" {} \"float {}vroughness\" {}", prefix,
                              number(along_v ? narrow : wide), prefix, number(along_v ? wide : narrow));
  }
  return text + value(prefix + "roughness", m.metallic_roughness_texture,
                      [&](const Vec4& t) { return sqr(m.roughness * t.y); });
}

std::string MaterialWriter::texture(const std::string& type, const TextureRef& ref, std::span<const uint8_t> rgb,
                                    const char* encoding) {
  const Texture& t = scene_.textures[static_cast<size_t>(ref.texture)];
  const int index = textures_++;
  const std::string file = output_.add_png(fmt::format("texture-{}.png", index), rgb, t.width, t.height);
  const std::string name = in_quotes(fmt::format("texture {}", index));
  std::string line = fmt::format("Texture {} \"{}\" \"imagemap\" \"string filename\" {} \"string encoding\" \"{}\"",
                                 name, type, file, encoding);
  if (t.wrap_u == WrapMode::clamp && t.wrap_v == WrapMode::clamp) line += " \"string wrap\" \"clamp\"";
  if (t.wrap_u == WrapMode::mirror || t.wrap_u != t.wrap_v)
    output_.note("textures that mirror, or that wrap differently across and down, repeat");
  if (t.filter == FilterMode::nearest) line += " \"string filter\" \"point\"";
  if (ref.rotation_rad != 0) output_.note("textures are written without their rotation");
  if (ref.uv_set != 0) output_.note("textures use the first set of texture coordinates");
  // pbrt's v points upwards.
  const Vec2 delta(ref.offset.x, 1 - ref.scale.y - ref.offset.y);
  if (ref.scale != Vec2(1) || delta != Vec2(0))
    line += fmt::format(" \"float uscale\" {} \"float vscale\" {} \"float udelta\" {} \"float vdelta\" {}",
                        number(ref.scale.x), number(ref.scale.y), number(delta.x), number(delta.y));
  output_.line(line);
  return name;
}

std::string MaterialWriter::color(const std::string& name, const TextureRef& ref,
                                  const std::function<Rgb(const Vec4&)>& color) {
  if (!ref.used()) return fmt::format(" \"rgb {}\" {}", name, numbers(in_range(color(Vec4(1)))));
  const Texture& t = scene_.textures[static_cast<size_t>(ref.texture)];
  std::vector<uint8_t> rgb(3 * texel_count(t));
  for (size_t i = 0; i < texel_count(t); ++i) {
    const Rgb display = srgb_from_linear(in_range(color(texel_at(t, i))));
    for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = quantise_unorm8(display[static_cast<int>(c)]);
  }
  return fmt::format(" \"texture {}\" {}", name, texture("spectrum", ref, rgb, "sRGB"));
}

std::string MaterialWriter::value(const std::string& name, const TextureRef& ref,
                                  const std::function<float(const Vec4&)>& value) {
  if (!ref.used()) return fmt::format(" \"float {}\" {}", name, number(value(Vec4(1))));
  const Texture& t = scene_.textures[static_cast<size_t>(ref.texture)];
  std::vector<uint8_t> rgb(3 * texel_count(t));
  bool varies = false;
  for (size_t i = 0; i < texel_count(t); ++i) {
    const uint8_t code = quantise_unorm8(value(texel_at(t, i)));
    for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = code;
    varies |= code != rgb[0];
  }
  if (!varies) return fmt::format(" \"float {}\" {}", name, number(value(texel_at(t, 0))));
  return fmt::format(" \"texture {}\" {}", name, texture("float", ref, rgb, "linear"));
}

std::string MaterialWriter::normal_map(const Material& m) {
  if (!m.normal_texture.used() || m.unlit) return "";
  const Texture& t = scene_.textures[static_cast<size_t>(m.normal_texture.texture)];
  if (m.normal_texture.scale != Vec2(1) || m.normal_texture.offset != Vec2(0) || m.normal_texture.rotation_rad != 0)
    output_.note("normal maps are written without their transform");
  std::vector<uint8_t> rgb(3 * texel_count(t));
  for (size_t i = 0; i < texel_count(t); ++i) {
    const Vec3 stored = Vec3(texel_at(t, i)) * 2.0f - 1.0f;
    const Vec3 normal = glm::normalize(Vec3(Vec2(stored) * m.normal_scale, std::max(stored.z, 1e-3f)));
    for (size_t c = 0; c < 3; ++c) rgb[3 * i + c] = quantise_unorm8((normal[static_cast<int>(c)] + 1) / 2);
  }
  const std::string file = output_.add_png(fmt::format("texture-{}.png", textures_++), rgb, t.width, t.height);
  return " \"string normalmap\" " + file;
}

std::string MaterialWriter::area_light(const Material& m) {
  const Rgb radiance = m.unlit ? m.base_color : m.emission;
  const TextureRef& ref = m.unlit ? m.base_color_texture : m.emission_texture;
  if (is_black(radiance)) return "";
  const std::string sides = m.double_sided ? " \"bool twosided\" true" : "";
  if (!ref.used()) return "AreaLightSource \"diffuse\" \"rgb L\" " + numbers(radiance) + sides;
  if (ref.scale != Vec2(1) || ref.offset != Vec2(0) || ref.rotation_rad != 0)
    output_.note("textures of emission are written without their transform");
  const Texture& t = scene_.textures[static_cast<size_t>(ref.texture)];
  Image image(t.width, t.height);
  for (size_t i = 0; i < texel_count(t); ++i) image.pixels[i] = radiance * Rgb(texel_at(t, i));
  const std::string file = output_.add_file(fmt::format("texture-{}.exr", textures_++),
                                            [&](const std::filesystem::path& target) { write_image(target, image); });
  return "AreaLightSource \"diffuse\" \"string filename\" " + file + sides;
}

std::string MaterialWriter::alpha(const Material& m) {
  if (m.alpha_mode == AlphaMode::opaque) return "";
  return value("alpha", m.base_color_texture, [&](const Vec4& t) {
    const float alpha = saturate(m.alpha * t.w);
    if (m.alpha_mode == AlphaMode::mask) return alpha < m.alpha_cutoff ? 0.0f : 1.0f;
    return alpha;
  });
}

std::string MaterialWriter::medium(const Material& m) {
  const bool absorbs =
      is_transparent(m) && m.thickness > 0 && is_finite(m.attenuation_distance) && m.attenuation_color != Rgb(1);
  if (!absorbs) return "";
  const Rgb absorption = -glm::log(glm::max(m.attenuation_color, Rgb(1e-6f))) / m.attenuation_distance;
  const std::string name = in_quotes(name_);
  output_.line(
      fmt::format("MakeNamedMedium {} \"string type\" \"homogeneous\" \"rgb sigma_a\" {} \"rgb sigma_s\" [ 0 "
                  "0 0 ]",
                  name, numbers(absorption)));
  return name;
}

void MaterialWriter::note_parts(const Material& m) {
  const auto note = [&](bool is_used, const char* part, const char* instead) {
    if (is_used) output_.note(fmt::format("material '{}': {}, {}", m.name, part, instead));
  };
  note(m.unlit, "an unlit surface", "emits its colour");
  if (m.cull_back_faces) output_.note("faces that are invisible from behind become visible");
  if (m.mix_first != kNone) {
    const auto has_normals = [&](Index part) {
      return scene_.materials[static_cast<size_t>(part)].normal_texture.used();
    };
    note(m.normal_texture.used() && !(has_normals(m.mix_first) && has_normals(m.mix_second)),
         "the normal map of a mixture", "which pbrt supports in parts only, is left out");
    return;
  }
  note(!is_black(m.sheen_color), "sheen", "which pbrt cannot represent, is left out");
  note(m.iridescence > 0, "iridescence", "which pbrt cannot represent, is left out");
  note(is_transparent(m) && (m.base_color != Rgb(1) || m.base_color_texture.used()), "the tint of transmitted light",
       "which pbrt cannot represent, is left out");
  note(is_transparent(m) && !(m.thickness > 0) && m.roughness > 0.03f, "the roughness of a thin wall",
       "which pbrt cannot represent, is left out");
  note(m.diffuse_transmission > 0 && m.specular > 0 && m.ior > 1, "the reflection above diffuse transmission",
       "which pbrt cannot represent, is left out");
  note(m.diffuse_transmission_texture.used(), "the texture of the share of diffuse transmission", "is left out");
  note(m.anisotropy_texture.used() || (m.anisotropy > 0 && m.metallic_roughness_texture.used()),
       "the texture of anisotropic roughness", "is left out");
  note(m.clearcoat_texture.used() || m.clearcoat_roughness_texture.used(), "the texture of a clearcoat", "is left out");
  note(m.clearcoat > 0 && (m.metallic < 1 || m.clearcoat < 1), "a clearcoat",
       "is written on metals only, with full strength from one half on");
  note(m.specular_texture.used() || m.specular_color_texture.used(), "textures of specular reflection", "are left out");
  note(m.microfacet_model != MicrofacetModel::ggx && m.roughness > 0, "Beckmann microfacets", "become GGX");
}

}  // namespace relume::pbrt
