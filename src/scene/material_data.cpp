#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "scene/material_parameters.h"

namespace relume {
namespace {

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

/// Copies the members of `Data` in the table.
template <typename Data>
void copy_parameters(const Material& m, Data& data) {
  for_each_parameter(m, [&](const MaterialParameter& parameter, const auto& value) {
    const auto converted = kernel_value(value, parameter.kernel_range);
    using Target = std::remove_const_t<decltype(converted)> Data::*;
    const auto copy = [&](auto target) {
      if constexpr (std::is_same_v<decltype(target), Target>) data.*target = converted;
    };
    std::visit(copy, parameter.kernel);
  });
}

/// Whether the clearcoat has normals other than its base.
bool has_own_coat_normal(const Material& m) {
  if (!(m.clearcoat > 0.0f)) return false;
  const TextureRef& base = m.normal_texture;
  const TextureRef& coat = m.clearcoat_normal_texture;
  if (!base.used() && !coat.used()) return false;
  return base.texture != coat.texture || base.uv_set != coat.uv_set || base.offset != coat.offset ||
         base.scale != coat.scale || base.rotation_rad != coat.rotation_rad ||
         m.normal_scale != m.clearcoat_normal_scale;
}

std::string values_of(const MaterialParameter& p) {
  if (!p.choices.empty()) return fmt::format("`{}`", fmt::join(p.choices, "`, `"));
  if (std::holds_alternative<bool Material::*>(p.member)) return "true, false";
  const char* kind = std::holds_alternative<Rgb Material::*>(p.member) ? "colour" : "number";
  if (p.range.high == kInfinity) return fmt::format("{} from {:g}", kind, p.range.low);
  return fmt::format("{} in [{:g}, {:g}]", kind, p.range.low, p.range.high);
}

}  // namespace

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
  copy_parameters(m, d);
  for (const TextureRef* ref : texture_refs(m)) d.uses_uv = d.uses_uv || ref->used();
  d.mix_first = m.mix_first;
  d.mix_second = m.mix_second;
  d.mask = m.alpha_mode == AlphaMode::mask;
  d.blend = m.alpha_mode == AlphaMode::blend;
  d.volume = m.thickness > 0.0f && (m.transmission > 0.0f || m.diffuse_transmission > 0.0f);
  if (!d.volume || d.transmission == 0.0f || d.ior == 1.0f) d.dispersion = 0.0f;
  d.cull_back_faces = m.cull_back_faces && !m.double_sided && !d.volume;
  if (d.volume && is_finite(m.attenuation_distance) && m.attenuation_distance > 0.0f) {
    for (int c = 0; c < 3; ++c)
      d.absorption[c] = -std::log(std::max(m.attenuation_color[c], 1e-6f)) / m.attenuation_distance;
  }
  return d;
}

std::optional<LayerData> layer_data(const Material& m) {
  LayerData d;
  copy_parameters(m, d);
  d.coat_has_normal = has_own_coat_normal(m);
  const bool visible = d.anisotropy > 0.0f || !is_black(d.sheen_color) || d.iridescence > 0.0f ||
                       d.diffuse_transmission > 0.0f || d.coat_has_normal;
  return visible ? std::optional(d) : std::nullopt;
}

std::string material_parameters_reference() {
  std::string text =
      "# Material parameters\n\nMade by `relume scenes --materials` from the declarations in the code. Keys are those "
      "of `materials`\nin [scene files](scene-json.md#materials); [materials](materials.md) describes their "
      "effects.\n\n| key | values | meaning |\n|---|---|---|\n";
  for (const MaterialParameter& p : material_parameters()) {
    if (std::holds_alternative<TextureRef Material::*>(p.member)) continue;
    const std::string in_gltf =
        p.gltf.extension ? fmt::format("`{}` of {}", p.gltf.key, p.gltf.extension) : "as in glTF";
    text += fmt::format("| `{}` | {} | {} |\n", p.key, values_of(p), *p.meaning ? p.meaning : in_gltf);
  }
  return text;
}

}  // namespace relume
