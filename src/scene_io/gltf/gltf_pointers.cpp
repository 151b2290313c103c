#include "scene_io/gltf/gltf_pointers.h"

#include <charconv>

#include <fmt/format.h>

#include "scene/light_parameters.h"
#include "scene/material_parameters.h"

namespace relume::gltf {
namespace {

constexpr std::string_view kPrefixes[] = {"/materials/", "/extensions/KHR_lights_punctual/lights/", "/cameras/"};

struct CoreParameter {
  const char* tail;
  const char* parameter;
  int components = 1;
};

/// Core glTF. The base colour factor also drives alpha; factor and strength of emission drive their product.
constexpr CoreParameter kMaterial[] = {{"pbrMetallicRoughness/baseColorFactor", "base_color", 4},
                                       {"pbrMetallicRoughness/metallicFactor", "metallic"},
                                       {"pbrMetallicRoughness/roughnessFactor", "roughness"},
                                       {"normalTexture/scale", "normal_scale"},
                                       {"alphaCutoff", "alpha_cutoff"},
                                       {"emissiveFactor", "emission", 3},
                                       {"extensions/KHR_materials_emissive_strength/emissiveStrength", "emission", 1}};

/// Texture properties and their keys in relume.
constexpr CoreParameter kTextures[] = {{"pbrMetallicRoughness/baseColorTexture", "base_color"},
                                       {"pbrMetallicRoughness/metallicRoughnessTexture", "metallic_roughness"},
                                       {"normalTexture", "normal"},
                                       {"emissiveTexture", "emission"}};

void add_transform(const std::string& texture, const std::string& key, std::vector<PointerParameter>& list) {
  const std::string tail = texture + "/extensions/KHR_texture_transform/";
  list.push_back({AnimatedPart::material, tail + "offset", key + "_texture.offset", 2});
  list.push_back({AnimatedPart::material, tail + "scale", key + "_texture.scale", 2});
  list.push_back({AnimatedPart::material, tail + "rotation", key + "_texture.rotation", 1});
}

std::vector<PointerParameter> make_parameters() {
  std::vector<PointerParameter> list;
  for (const CoreParameter& p : kMaterial) list.push_back({AnimatedPart::material, p.tail, p.parameter, p.components});
  for (const CoreParameter& p : kTextures) add_transform(p.tail, p.parameter, list);
  for (const MaterialParameter& p : material_parameters()) {
    if (!p.gltf.extension) continue;
    const std::string tail = fmt::format("extensions/{}/{}", p.gltf.extension, p.gltf.key);
    if (std::holds_alternative<float Material::*>(p.member))
      list.push_back({AnimatedPart::material, tail, p.key, 1});
    else if (std::holds_alternative<Rgb Material::*>(p.member))
      list.push_back({AnimatedPart::material, tail, p.key, 3});
    else if (std::holds_alternative<TextureRef Material::*>(p.member))
      add_transform(tail, p.key, list);
  }
  list.push_back({AnimatedPart::light, "color", "intensity", 3});
  list.push_back({AnimatedPart::light, "intensity", "intensity", 1});
  list.push_back({AnimatedPart::light, "spot/innerConeAngle", "inner_cone", 1});
  list.push_back({AnimatedPart::light, "spot/outerConeAngle", "outer_cone", 1});
  list.push_back({AnimatedPart::camera, "perspective/yfov", "fov_y", 1});
  list.push_back({AnimatedPart::camera, "orthographic/ymag", "half_height", 1});
  return list;
}

}  // namespace

const std::vector<PointerParameter>& pointer_parameters() {
  static const std::vector<PointerParameter> kParameters = make_parameters();
  return kParameters;
}

std::optional<ParameterPointer> parse_parameter_pointer(std::string_view pointer) {
  for (size_t part = 0; part < std::size(kPrefixes); ++part) {
    if (!pointer.starts_with(kPrefixes[part])) continue;
    std::string_view rest = pointer.substr(kPrefixes[part].size());
    int index = -1;
    const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), index);
    if (parsed.ec != std::errc{} || parsed.ptr == rest.data() + rest.size() || *parsed.ptr != '/') return std::nullopt;
    rest.remove_prefix(static_cast<size_t>(parsed.ptr - rest.data()) + 1);
    for (const PointerParameter& p : pointer_parameters()) {
      if (p.part == static_cast<AnimatedPart>(part) && p.tail == rest) return ParameterPointer{index, &p};
    }
  }
  return std::nullopt;
}

std::string pointer_to(const PointerParameter& parameter, Index index) {
  return fmt::format("{}{}/{}", kPrefixes[static_cast<size_t>(parameter.part)], index, parameter.tail);
}

}  // namespace relume::gltf
