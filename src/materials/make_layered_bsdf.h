// Converts glTF parameters to lobes for materials with layers beyond make_bsdf.h: sheen, an iridescent film,
// anisotropic microfacets, diffuse transmission, a clearcoat with separate normals.
#pragma once

#include "materials/layers.h"
#include "materials/make_bsdf.h"

namespace relume {

namespace bsdf_assembly {

RELUME_HD inline void add_sheen(Bsdf& bsdf, const LayerSample& l) {
  if (is_black(l.sheen_color)) return;
  const float alpha = relume::max(sqr(l.sheen_roughness), kMinSheenAlpha);
  Lobe& lobe = add(bsdf, LobeKind::sheen, {MicrofacetModel::ggx, alpha});
  lobe.color = l.sheen_color;
  bsdf.sheen = max_component(l.sheen_color);
}

/// Fills bsdf.detail.anisotropy (KHR_materials_anisotropy: α along the tangent approaches 1 with the square of the
/// strength). Returns microfacets with the geometric mean of both widths; `plain` without anisotropy.
RELUME_HD inline Microfacet fill_anisotropy(Bsdf& bsdf, const LayerSample& l, const Microfacet& plain) {
  if (!(l.anisotropy > 0.0f)) return plain;
  AnisotropicGgx& mf = bsdf.detail.anisotropy;
  mf.strength = l.anisotropy;
  mf.alpha_b = relume::max(plain.alpha, kMinAlpha);
  mf.alpha_t = lerp(mf.alpha_b, 1.0f, sqr(l.anisotropy));
  mf.tangent = l.anisotropy_direction;
  return {MicrofacetModel::ggx, std::sqrt(mf.alpha_t * mf.alpha_b)};
}

/// Adds the base of `shares` and the interface over it.
struct LayeredBase {
  Bsdf& bsdf;
  const MaterialSample& m;
  const LayerSample& l;
  const BaseShares shares;
  const Microfacet microfacet;
  const bool anisotropic;
  Rgb f0[2];  ///< of dielectric and metal, for albedos
  float f90;  ///< of the dielectric
  bool film;

  RELUME_HD LayeredBase(Bsdf& target, const MaterialSample& sample, const LayerSample& layers,
                        const MaterialData& material)
      : bsdf(target),
        m(sample),
        l(layers),
        shares(base_shares(sample, material)),
        microfacet(fill_anisotropy(target, layers, {material.microfacet_model, sqr(sample.roughness)})),
        anisotropic(layers.anisotropy > 0.0f),
        f0{shares.dielectric_f0, sample.base_color},
        f90(shares.dielectric_f90),
        film(layers.iridescence > 0.0f) {
    if (!film) return;
    bsdf.detail.film = {l.iridescence,        l.iridescence_ior, l.iridescence_thickness_nm,
                        shares.dielectric_f0, m.specular,        m.base_color};
    if (m.metallic < 1.0f) f0[0] = film_f0_bound(bsdf.detail.film, FilmBase::dielectric);
    if (m.metallic > 0.0f) f0[1] = film_f0_bound(bsdf.detail.film, FilmBase::metal);
    f90 = 1;
  }

  RELUME_HD void add_reflection(FilmBase base, const Rgb& base_f0, float base_f90, float weight) const {
    if (!(weight > 0.0f) || (is_black(base_f0) && base_f90 == 0.0f)) return;
    Lobe& lobe = bsdf_assembly::add_reflection(bsdf, base_f0, base_f90, microfacet);
    lobe.weight = weight;
    lobe.anisotropic = anisotropic;
    if (film) lobe.film = base;
  }

  RELUME_HD void add_multiple_reflection(const EnergyTables& tables) const {
    if (!(m.metallic > 0.0f) || microfacet.smooth()) return;
    const float average = anisotropic ? tables.anisotropic.average_shares(bsdf.detail.anisotropy).total
                                      : tables.of(microfacet.model).average_shares(m.roughness).total;
    Lobe* lobe = bsdf_assembly::add_multiple_reflection(bsdf, f0[1], m.metallic, average, microfacet);
    if (lobe) lobe->anisotropic = anisotropic;
  }

  RELUME_HD void add_diffuse(LobeKind kind, const Rgb& color) const {
    if (is_black(color)) return;
    Lobe& lobe = add(bsdf, kind, microfacet);
    lobe.color = color;
    lobe.anisotropic = anisotropic;
  }
};

}  // namespace bsdf_assembly

/// As make_bsdf(), with the additional layers of `l`. `tables`: layered_energy_tables() with those of the material's
/// layers. Transmission through rough interfaces is isotropic.
RELUME_HD inline void make_layered_bsdf(Bsdf& bsdf, const MaterialSample& m, const LayerSample& l,
                                        const MaterialData& material, const EnergyTables& tables, float cos_theta_o,
                                        bool front_face) {
  using namespace bsdf_assembly;
  clear(bsdf);
  bsdf.layered = true;
  bsdf.sheen = 0;
  bsdf.coat_has_normal = false;
  bsdf.tables = &tables;
  for (Lobe& lobe : bsdf.lobes) {
    lobe.film = FilmBase::none;
    lobe.anisotropic = false;
  }
  if (m.clearcoat > 0.0f) {
    add_clearcoat(bsdf, m, material.microfacet_model);
    bsdf.coat_has_normal = l.coat_has_normal;
    bsdf.detail.coat_normal = l.coat_normal;
  }
  add_sheen(bsdf, l);
  const LayeredBase base(bsdf, m, l, material);
  const BaseShares& shares = base.shares;
  bsdf.interface = interface_of(m, material, base.f0[0], base.f90, front_face);
  base.add_reflection(FilmBase::dielectric, base.f0[0], base.f90, shares.interface_share);
  base.add_reflection(FilmBase::metal, base.f0[1], 1, m.metallic);
  base.add_multiple_reflection(tables);
  base.add_diffuse(LobeKind::covered_lambert, m.base_color * (shares.diffuse * (1.0f - l.diffuse_transmission)));
  base.add_diffuse(LobeKind::diffuse_transmission,
                   l.diffuse_transmission_color * (shares.diffuse * l.diffuse_transmission));
  if (shares.transparent > 0.0f) {
    Lobe& lobe = add_transmission(bsdf, m, material, shares.transparent, {material.microfacet_model, sqr(m.roughness)});
    if (base.film) lobe.film = FilmBase::dielectric;
  }
  prepare(bsdf, cos_theta_o);
}

}  // namespace relume
