// Parameters that few materials have, stored apart from those read at every hit. relume/scene.h documents them.
#pragma once

#include "core/math.h"
#include "core/vec.h"
#include "materials/texture.h"

namespace relume {

struct LayerData {
  float anisotropy = 0;
  float anisotropy_rotation_rad = 0;
  Rgb sheen_color{0};
  float sheen_roughness = 0;
  float iridescence = 0;
  float iridescence_ior = 1.3f;
  float iridescence_thickness_min_nm = 100;
  float iridescence_thickness_nm = 400;
  float diffuse_transmission = 0;
  Rgb diffuse_transmission_color{1};
  float clearcoat_normal_scale = 1;

  TextureUse anisotropy_texture;
  TextureUse sheen_color_texture;
  TextureUse sheen_roughness_texture;
  TextureUse iridescence_texture;
  TextureUse iridescence_thickness_texture;
  TextureUse diffuse_transmission_texture;
  TextureUse diffuse_transmission_color_texture;
  TextureUse clearcoat_normal_texture;

  bool coat_has_normal = false;  ///< the clearcoat has separate normals
};

/// The parameters at one point with textures applied, and their directions in the frame of the point.
struct LayerSample {
  float anisotropy = 0;
  Vec2 anisotropy_direction{1, 0};  ///< along tangent and bitangent from sample_layers(); later in the frame
  Rgb sheen_color{0};
  float sheen_roughness = 0;
  float iridescence = 0;
  float iridescence_ior = 1.3f;
  float iridescence_thickness_nm = 400;
  float diffuse_transmission = 0;
  Rgb diffuse_transmission_color{1};
  bool coat_has_normal = false;
  Vec3 coat_normal{0, 0, 1};  ///< unit, if coat_has_normal
};

/// `fetch(use)` samples a texture at that point.
template <typename Fetch>
RELUME_HD inline LayerSample sample_layers(const LayerData& d, const Fetch& fetch) {
  LayerSample s;
  s.anisotropy = d.anisotropy;
  Vec2 direction(1, 0);
  if (d.anisotropy > 0.0f && d.anisotropy_texture.used()) {
    const Vec4 t = fetch(d.anisotropy_texture);
    direction = Vec2(2.0f * t.x - 1.0f, 2.0f * t.y - 1.0f);
    s.anisotropy *= t.z;
  }
  const Vec2 turn = math::unit_vector(d.anisotropy_rotation_rad);
  s.anisotropy_direction = {turn.x * direction.x - turn.y * direction.y, turn.y * direction.x + turn.x * direction.y};
  s.sheen_color = d.sheen_color;
  if (d.sheen_color_texture.used()) s.sheen_color *= Rgb(fetch(d.sheen_color_texture));
  s.sheen_roughness = d.sheen_roughness;
  if (d.sheen_roughness_texture.used()) s.sheen_roughness *= fetch(d.sheen_roughness_texture).w;
  s.iridescence = d.iridescence;
  if (d.iridescence_texture.used()) s.iridescence *= fetch(d.iridescence_texture).x;
  s.iridescence_ior = d.iridescence_ior;
  s.iridescence_thickness_nm = d.iridescence_thickness_nm;
  if (d.iridescence_thickness_texture.used()) {
    s.iridescence_thickness_nm =
        lerp(d.iridescence_thickness_min_nm, d.iridescence_thickness_nm, fetch(d.iridescence_thickness_texture).y);
  }
  s.diffuse_transmission = d.diffuse_transmission;
  if (d.diffuse_transmission_texture.used()) s.diffuse_transmission *= fetch(d.diffuse_transmission_texture).w;
  s.diffuse_transmission_color = d.diffuse_transmission_color;
  if (d.diffuse_transmission_color_texture.used())
    s.diffuse_transmission_color *= Rgb(fetch(d.diffuse_transmission_color_texture));
  return s;
}

}  // namespace relume
