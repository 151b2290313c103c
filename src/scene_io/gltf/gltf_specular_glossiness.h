// Rewrites KHR_materials_pbrSpecularGlossiness as its successor.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace relume::gltf {

/// Reflectance at normal incidence of the default index of refraction, 1.5. KHR_materials_specular scales it.
inline constexpr double kDefaultF0 = 0.04;

/// Adds equivalent core parameters and KHR_materials_specular to the materials of a checked glTF document that use the
/// extension. F0 is the specular colour; α is the square of 1 − glossiness. The roughness texture is marked by
/// `extras.relume.glossiness`, the factor of its image's alpha.
void convert_specular_glossiness(nlohmann::json& root);

}  // namespace relume::gltf
