// The members of a material, each described once. Validation, hashes, relume JSON, glTF's extensions, what kernels read
// and the viewer follow from this list.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "materials/layers.h"
#include "materials/material.h"
#include "scene/scene.h"

namespace relume {

struct ParameterRange {
  float low = -kInfinity;
  float high = kInfinity;
};

/// Where the KHR extensions of glTF have a parameter; glTF's core materials have readers of their own.
struct GltfMember {
  const char* extension = nullptr;  ///< nullptr: not in an extension
  const char* key = nullptr;
};

/// How the viewer shows a parameter; those that it shows are saved with a view.
struct ParameterWidget {
  enum class Kind : uint8_t { none, color, share, radiance, number };
  Kind kind = Kind::none;
  const char* label = "";
  const char* help = "";  ///< radiance: its unit
  float most = 1;         ///< number: end of the slider
};

struct MaterialParameter {
  using Member = std::variant<float Material::*, Rgb Material::*, bool Material::*, AlphaMode Material::*,
                              MicrofacetModel Material::*, TextureRef Material::*>;
  using KernelMember =
      std::variant<std::monostate, float MaterialData::*, Rgb MaterialData::*, bool MaterialData::*,
                   AlphaMode MaterialData::*, MicrofacetModel MaterialData::*, TextureUse MaterialData::*,
                   float LayerData::*, Rgb LayerData::*, TextureUse LayerData::*>;

  const char* key;   ///< in relume JSON; of textures, which it cannot set: of the parameter they multiply
  const char* name;  ///< in messages
  Member member;
  KernelMember kernel = {};          ///< the copy that kernels read; none: they read what material_data() derives
  ParameterRange range = {};         ///< of numbers and of each channel of colours, in files
  ParameterRange kernel_range = {};  ///< to which numbers are limited for kernels
  GltfMember gltf = {};
  bool color_texture = false;                ///< glTF stores the texels as sRGB colours
  float Material::*texture_scale = nullptr;  ///< of normal textures: glTF has it in the texture's object, as "scale"
  std::span<const std::string_view> choices = {};  ///< words in relume JSON for the values of an enumeration
  ParameterWidget widget = {};
  const char* meaning = "";  ///< in the reference page; empty: what `gltf` says
};

/// In the order of Material.
std::span<const MaterialParameter> material_parameters();

/// Calls f(parameter, material.*member) for each parameter, with the member's own type.
template <typename AnyMaterial, typename F>
void for_each_parameter(AnyMaterial& material, const F& f) {
  for (const MaterialParameter& parameter : material_parameters())
    std::visit([&](auto member) { f(parameter, material.*member); }, parameter.member);
}

/// A material as kernels see it; its index of layers is for the caller to set.
MaterialData material_data(const Material& material);
/// Its layers; none if it has none that can be seen.
std::optional<LayerData> layer_data(const Material& material);

/// Text of docs/material-parameters.md.
std::string material_parameters_reference();

}  // namespace relume
