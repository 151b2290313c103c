#include "scene/material_parameters.h"

#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace relume {
namespace {

using Kind = ParameterWidget::Kind;

constexpr ParameterRange kShare{0, 1};
constexpr ParameterRange kPositive{0, 1e30f};
constexpr std::string_view kAlphaModes[] = {"opaque", "mask", "blend"};
constexpr std::string_view kMicrofacetModels[] = {"ggx", "beckmann"};

constexpr const char* kIor = "KHR_materials_ior";
constexpr const char* kSpecular = "KHR_materials_specular";
constexpr const char* kTransmission = "KHR_materials_transmission";
constexpr const char* kVolume = "KHR_materials_volume";
constexpr const char* kClearcoat = "KHR_materials_clearcoat";

using M = Material;
using D = MaterialData;

// clang-format off: one field a line
const std::array kParameters = {
    MaterialParameter{.key = "base_color",
                      .name = "base colour",
                      .member = &M::base_color,
                      .kernel = &D::base_color,
                      .range = kShare,
                      .widget = {Kind::color, "base color"}},
    MaterialParameter{.key = "alpha", .name = "alpha", .member = &M::alpha, .kernel = &D::alpha, .range = kShare},
    MaterialParameter{.key = "base_color",
                      .name = "base colour",
                      .member = &M::base_color_texture,
                      .kernel = &D::base_color_texture,
                      .color_texture = true},
    MaterialParameter{.key = "metallic",
                      .name = "metallic",
                      .member = &M::metallic,
                      .kernel = &D::metallic,
                      .range = kShare,
                      .kernel_range = kShare,
                      .widget = {Kind::share, "metallic", "0: a dielectric, 1: a metal"}},
    MaterialParameter{
        .key = "roughness",
        .name = "roughness",
        .member = &M::roughness,
        .kernel = &D::roughness,
        .range = kShare,
        .kernel_range = kShare,
        .widget = {Kind::share, "roughness", "Perceptual; the square is the width of the microfacet distribution"}},
    MaterialParameter{.key = "metallic_roughness",
                      .name = "metallic and roughness",
                      .member = &M::metallic_roughness_texture,
                      .kernel = &D::metallic_roughness_texture},
    MaterialParameter{.key = "normal", .name = "normal", .member = &M::normal_texture, .kernel = &D::normal_texture},
    MaterialParameter{.key = "normal_scale",
                      .name = "normal scale",
                      .member = &M::normal_scale,
                      .kernel = &D::normal_scale,
                      .range = {-1e30f, 1e30f},
                      .kernel_range = {-1e3f, 1e3f}},  // squares of bright texels are finite
    MaterialParameter{.key = "emission",
                      .name = "emission",
                      .member = &M::emission,
                      .kernel = &D::emission,
                      .range = {0, kMaxRadiance},
                      .widget = {Kind::radiance, "emission", "W/(sr m\xc2\xb2)"},
                      .meaning = "radiance: emissive factor × KHR_materials_emissive_strength"},
    MaterialParameter{.key = "emission",
                      .name = "emission",
                      .member = &M::emission_texture,
                      .kernel = &D::emission_texture,
                      .color_texture = true},
    MaterialParameter{.key = "alpha_mode", .name = "alpha mode", .member = &M::alpha_mode, .choices = kAlphaModes},
    MaterialParameter{.key = "alpha_cutoff",
                      .name = "alpha cutoff",
                      .member = &M::alpha_cutoff,
                      .kernel = &D::alpha_cutoff,
                      .range = kShare},
    MaterialParameter{.key = "double_sided",
                      .name = "double sided",
                      .member = &M::double_sided,
                      .kernel = &D::double_sided,
                      .meaning = "emission leaves from the front only unless set"},
    MaterialParameter{.key = "unlit",
                      .name = "unlit",
                      .member = &M::unlit,
                      .kernel = &D::unlit,
                      .meaning = "KHR_materials_unlit: the base colour is emitted, nothing is reflected"},
    MaterialParameter{.key = "ior",
                      .name = "index of refraction",
                      .member = &M::ior,
                      .kernel = &D::ior,
                      .range = {1, 1000},
                      .kernel_range = {.low = 1},
                      .gltf = {kIor, "ior"},
                      .widget = {Kind::number, "ior", "Index of refraction", 3}},
    MaterialParameter{.key = "specular",
                      .name = "specular",
                      .member = &M::specular,
                      .kernel = &D::specular,
                      .range = kShare,
                      .kernel_range = kShare,
                      .gltf = {kSpecular, "specularFactor"},
                      .widget = {Kind::share, "specular", "Strength of the dielectric reflection"}},
    MaterialParameter{.key = "specular",
                      .name = "specular",
                      .member = &M::specular_texture,
                      .kernel = &D::specular_texture,
                      .gltf = {kSpecular, "specularTexture"}},
    MaterialParameter{.key = "specular_color",
                      .name = "specular colour",
                      .member = &M::specular_color,
                      .kernel = &D::specular_color,
                      .range = kPositive,
                      .gltf = {kSpecular, "specularColorFactor"}},
    MaterialParameter{.key = "specular_color",
                      .name = "specular colour",
                      .member = &M::specular_color_texture,
                      .kernel = &D::specular_color_texture,
                      .gltf = {kSpecular, "specularColorTexture"},
                      .color_texture = true},
    MaterialParameter{.key = "transmission",
                      .name = "transmission",
                      .member = &M::transmission,
                      .kernel = &D::transmission,
                      .range = kShare,
                      .kernel_range = kShare,
                      .gltf = {kTransmission, "transmissionFactor"},
                      .widget = {Kind::share, "transmission", "How much goes through instead of being scattered back"}},
    MaterialParameter{.key = "transmission",
                      .name = "transmission",
                      .member = &M::transmission_texture,
                      .kernel = &D::transmission_texture,
                      .gltf = {kTransmission, "transmissionTexture"}},
    MaterialParameter{.key = "thickness",
                      .name = "thickness",
                      .member = &M::thickness,
                      .range = kPositive,
                      .gltf = {kVolume, "thicknessFactor"}},
    MaterialParameter{.key = "attenuation_color",
                      .name = "attenuation colour",
                      .member = &M::attenuation_color,
                      .range = kShare,
                      .gltf = {kVolume, "attenuationColor"}},
    MaterialParameter{.key = "attenuation_distance",
                      .name = "attenuation distance",
                      .member = &M::attenuation_distance,
                      .range = {.low = 1e-6f},
                      .gltf = {kVolume, "attenuationDistance"}},
    MaterialParameter{.key = "clearcoat",
                      .name = "clearcoat",
                      .member = &M::clearcoat,
                      .kernel = &D::clearcoat,
                      .range = kShare,
                      .kernel_range = kShare,
                      .gltf = {kClearcoat, "clearcoatFactor"},
                      .widget = {Kind::share, "clearcoat", "A second, clear layer on top"}},
    MaterialParameter{.key = "clearcoat",
                      .name = "clearcoat",
                      .member = &M::clearcoat_texture,
                      .kernel = &D::clearcoat_texture,
                      .gltf = {kClearcoat, "clearcoatTexture"}},
    MaterialParameter{.key = "clearcoat_roughness",
                      .name = "clearcoat roughness",
                      .member = &M::clearcoat_roughness,
                      .kernel = &D::clearcoat_roughness,
                      .range = kShare,
                      .kernel_range = kShare,
                      .gltf = {kClearcoat, "clearcoatRoughnessFactor"},
                      .widget = {Kind::share, "coat roughness", "Of that layer"}},
    MaterialParameter{.key = "clearcoat_roughness",
                      .name = "clearcoat roughness",
                      .member = &M::clearcoat_roughness_texture,
                      .kernel = &D::clearcoat_roughness_texture,
                      .gltf = {kClearcoat, "clearcoatRoughnessTexture"}},
    MaterialParameter{.key = "microfacet_model",
                      .name = "microfacet model",
                      .member = &M::microfacet_model,
                      .kernel = &D::microfacet_model,
                      .choices = kMicrofacetModels,
                      .meaning = "distribution of microfacet normals"},
};
// clang-format on

TextureUse kernel_value(const TextureRef& ref, const ParameterRange&) {
  TextureUse u;
  if (!ref.used()) return u;
  u.texture = ref.texture;
  u.uv_set = static_cast<uint32_t>(ref.uv_set);
  const float c = std::cos(ref.rotation_rad);
  const float s = std::sin(ref.rotation_rad);
  u.transform = {c * ref.scale.x, s * ref.scale.y, -s * ref.scale.x, c * ref.scale.y, ref.offset};
  return u;
}

float kernel_value(float value, const ParameterRange& range) { return clamp(value, range.low, range.high); }

template <typename T>
T kernel_value(const T& value, const ParameterRange&) {
  return value;
}

std::string values_of(const MaterialParameter& p) {
  if (!p.choices.empty()) return fmt::format("`{}`", fmt::join(p.choices, "`, `"));
  if (std::holds_alternative<bool Material::*>(p.member)) return "true, false";
  const char* kind = std::holds_alternative<Rgb Material::*>(p.member) ? "colour" : "number";
  if (p.range.high == kInfinity) return fmt::format("{} from {:g}", kind, p.range.low);
  return fmt::format("{} in [{:g}, {:g}]", kind, p.range.low, p.range.high);
}

}  // namespace

std::span<const MaterialParameter> material_parameters() { return kParameters; }

std::vector<const TextureRef*> texture_refs(const Material& material) {
  std::vector<const TextureRef*> refs;
  for (const MaterialParameter& parameter : material_parameters()) {
    if (const auto* member = std::get_if<TextureRef Material::*>(&parameter.member))
      refs.push_back(&(material.**member));
  }
  return refs;
}

MaterialData material_data(const Material& m) {
  MaterialData d;
  for_each_parameter(m, [&](const MaterialParameter& parameter, const auto& value) {
    const auto converted = kernel_value(value, parameter.kernel_range);
    using Target = std::remove_const_t<decltype(converted)> MaterialData::*;
    if (const Target* target = std::get_if<Target>(&parameter.kernel)) d.** target = converted;
    if constexpr (std::is_same_v<Target, TextureUse MaterialData::*>) d.uses_uv = d.uses_uv || converted.used();
  });
  d.mask = m.alpha_mode == AlphaMode::mask;
  d.blend = m.alpha_mode == AlphaMode::blend;
  d.volume = m.thickness > 0.0f && m.transmission > 0.0f;
  if (d.volume && is_finite(m.attenuation_distance) && m.attenuation_distance > 0.0f) {
    for (int c = 0; c < 3; ++c)
      d.absorption[c] = -std::log(std::max(m.attenuation_color[c], 1e-6f)) / m.attenuation_distance;
  }
  return d;
}

std::string material_parameters_reference() {
  std::string text =
      "# Material parameters\n\n"
      "Made by `relume scenes --materials` from the declarations in the code. Keys are those of `materials` in\n"
      "[scene files](scene-json.md#materials); [materials](materials.md) tells what becomes of them.\n\n"
      "| key | values | meaning |\n|---|---|---|\n";
  for (const MaterialParameter& p : material_parameters()) {
    if (std::holds_alternative<TextureRef Material::*>(p.member)) continue;
    const std::string in_gltf =
        p.gltf.extension ? fmt::format("`{}` of {}", p.gltf.key, p.gltf.extension) : "as in glTF";
    text += fmt::format("| `{}` | {} | {} |\n", p.key, values_of(p), *p.meaning ? p.meaning : in_gltf);
  }
  return text;
}

}  // namespace relume
