// Materials for kernels; relume/scene.h documents each parameter.
#pragma once

#include "materials/dispersion.h"
#include "materials/fresnel.h"
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
  float ior = 1.5f;      ///< at the d line
  float dispersion = 0;  ///< 20 over the Abbe number; 0 without refraction
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
  TextureUse mix_texture;

  MicrofacetModel microfacet_model = MicrofacetModel::ggx;
  bool mask = false;   ///< covered where alpha ≥ alpha_cutoff
  bool blend = false;  ///< covered with probability alpha
  bool double_sided = false;
  bool cull_back_faces = false;  ///< the camera sees through backs; never set with a volume
  bool unlit = false;
  bool volume = false;     ///< whether the surface bounds a medium with refraction and absorption
  bool uses_uv = false;    ///< whether any texture is used
  int32_t layers = -1;     ///< index into SceneView::layers; −1: none
  int32_t mix_first = -1;  ///< index into SceneView::materials; −1: no mixture
  int32_t mix_second = -1;
  float mix_share = 0.5f;

  RELUME_HD bool emissive() const { return !unlit && !is_black(emission); }
  RELUME_HD bool has_alpha() const { return mask || blend; }
  RELUME_HD bool is_mixture() const { return mix_first >= 0; }
};

/// Transmittance of a smooth clearcoat for the emission below it, at `cos_theta` to the geometric normal
/// (KHR_materials_clearcoat). Light sampling and paths that hit the emitter both use it, with the same `clearcoat`.
RELUME_HD inline float emission_below_coat(float clearcoat, float cos_theta) {
  return 1.0f - clearcoat * (0.04f + 0.96f * pow5(saturate(1.0f - std::fabs(cos_theta))));
}

/// Parameters of a material at one point, with textures applied.
struct MaterialSample {
  Rgb base_color{1};
  float metallic = 0;
  float roughness = 1;
  float specular = 1;
  Rgb specular_color{1};
  float ior = 1.5f;  ///< at the path's wavelength
  float transmission = 0;
  float clearcoat = 0;
  float clearcoat_roughness = 0;
};

/// `fetch(use)` samples a texture at that point. `wavelength_nm`: of the path, or kNoWavelength.
template <typename Fetch>
RELUME_HD_INLINE MaterialSample sample_material(const MaterialData& m, float wavelength_nm, const Fetch& fetch) {
  MaterialSample s;
  s.base_color = m.base_color;
  s.metallic = m.metallic;
  s.roughness = m.roughness;
  s.specular = m.specular;
  s.specular_color = m.specular_color;
  s.ior = index_at(m.ior, m.dispersion, wavelength_nm);
  s.transmission = m.transmission;
  s.clearcoat = m.clearcoat;
  s.clearcoat_roughness = m.clearcoat_roughness;
  if (!m.uses_uv) return s;
  if (m.base_color_texture.used()) s.base_color *= Rgb(fetch(m.base_color_texture));
  if (m.metallic_roughness_texture.used()) {
    const Vec4 t = fetch(m.metallic_roughness_texture);
    s.roughness *= t.y;
    s.metallic *= t.z;
  }
  if (m.specular_texture.used()) s.specular *= fetch(m.specular_texture).w;
  if (m.specular_color_texture.used()) s.specular_color *= Rgb(fetch(m.specular_color_texture));
  if (m.transmission_texture.used()) s.transmission *= fetch(m.transmission_texture).x;
  if (m.clearcoat_texture.used()) s.clearcoat *= fetch(m.clearcoat_texture).x;
  if (m.clearcoat_roughness_texture.used()) s.clearcoat_roughness *= fetch(m.clearcoat_roughness_texture).y;
  return s;
}

}  // namespace relume
