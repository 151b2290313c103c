// KHR_materials_pbrSpecularGlossiness, rewritten as what replaced it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace relume::gltf {

/// Index of refraction 1.5, the default, has this reflectance at normal incidence; KHR_materials_specular scales it.
inline constexpr double kDefaultF0 = 0.04;

/// Gives the materials of a checked glTF document that have the extension the core parameters and the
/// KHR_materials_specular that mean the same: F0 is the specular colour, α the square of 1 − glossiness. The roughness
/// texture that this takes is a texture with `extras.relume.glossiness`, the factor of the alpha of its image.
void convert_specular_glossiness(nlohmann::json& root);

}  // namespace relume::gltf
