// Materials as kernels see them; scene/scene.h documents the meaning of each parameter.
#pragma once

#include "materials/microfacet.h"
#include "materials/texture.h"

namespace relume {

struct MaterialData {
  Rgb base_color{1};
  float alpha = 1;
  float metallic = 1;
  float roughness = 1;
  float normal_scale = 1;
  Rgb emission{0};
  float alpha_cutoff = 0.5f;
  Rgb specular_color{1};
  float specular = 1;
  float ior = 1.5f;
  float transmission = 0;
  Rgb absorption{0};  ///< per metre, inside
  float clearcoat = 0;
  float clearcoat_roughness = 0;

  TextureUse base_color_texture;
  TextureUse metallic_roughness_texture;
  TextureUse normal_texture;
  TextureUse emission_texture;
  TextureUse specular_texture;
  TextureUse specular_color_texture;
  TextureUse transmission_texture;
  TextureUse clearcoat_texture;
  TextureUse clearcoat_roughness_texture;

  MicrofacetModel microfacet_model = MicrofacetModel::ggx;
  bool mask = false;   ///< covered where alpha ≥ alpha_cutoff
  bool blend = false;  ///< covered with probability alpha
  bool double_sided = false;
  bool unlit = false;
  bool volume = false;   ///< the surface bounds a body: refraction and absorption
  bool uses_uv = false;  ///< any texture at all

  RELUME_HD bool emissive() const { return !unlit && !is_black(emission); }
  RELUME_HD bool has_alpha() const { return mask || blend; }
};

}  // namespace relume
