// Members of a material, each described once. Validation, hashes, relume JSON, glTF extensions, kernel data and the
// viewer use this list.
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

/// A parameter in the KHR extensions of glTF; the glTF core materials have separate readers.
struct GltfMember {
  const char* extension = nullptr;  ///< nullptr: not in an extension
  const char* key = nullptr;
};

/// Widget of a parameter in the viewer. Parameters with a widget are saved with a view.
struct ParameterWidget {
  enum class Kind : uint8_t { none, color, share, radiance, number };
  Kind kind = Kind::none;
  const char* label = "";
  const char* help = "";  ///< radiance: its unit
  float most = 1;         ///< number: upper end of the slider
};

struct MaterialParameter {
  using Member = std::variant<float Material::*, Rgb Material::*, bool Material::*, AlphaMode Material::*,
                              MicrofacetModel Material::*, TextureRef Material::*>;
  using KernelMember =
      std::variant<std::monostate, float MaterialData::*, Rgb MaterialData::*, bool MaterialData::*,
                   AlphaMode MaterialData::*, MicrofacetModel MaterialData::*, TextureUse MaterialData::*,
                   float LayerData::*, Rgb LayerData::*, TextureUse LayerData::*>;

  const char* key;   ///< in relume JSON; for textures, which it cannot set: the parameter they multiply
  const char* name;  ///< in messages
  Member member;
  KernelMember kernel = {};          ///< copy for kernels; none: kernels use data derived by material_data()
  ParameterRange range = {};         ///< valid range in files, of numbers and of each colour channel
  ParameterRange kernel_range = {};  ///< range to which numbers are clamped for kernels
  GltfMember gltf = {};
  bool color_texture = false;                      ///< glTF stores the texels as sRGB colours
  float Material::*texture_scale = nullptr;        ///< of normal textures: "scale" in the texture object of glTF
  std::span<const std::string_view> choices = {};  ///< names of enumeration values in relume JSON
  ParameterWidget widget = {};
  const char* meaning = "";  ///< on the reference page; empty: derived from `gltf`
};

/// In the order of Material.
std::span<const MaterialParameter> material_parameters();

/// Calls f(parameter, material.*member) for each parameter, with the member's type.
template <typename AnyMaterial, typename F>
void for_each_parameter(AnyMaterial& material, const F& f) {
  for (const MaterialParameter& parameter : material_parameters())
    std::visit([&](auto member) { f(parameter, material.*member); }, parameter.member);
}

/// Material data for kernels; the caller sets the index of layers.
MaterialData material_data(const Material& material);
/// Layers of the material; std::nullopt without visible layers.
std::optional<LayerData> layer_data(const Material& material);

/// Text of docs/material-parameters.md.
std::string material_parameters_reference();

}  // namespace relume
