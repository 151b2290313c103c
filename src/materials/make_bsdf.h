// Converts glTF parameters to lobes: metallic-roughness, specular, transmission, clearcoat.
#pragma once

#include "materials/bsdf.h"
#include "materials/material.h"

namespace relume {

namespace bsdf_assembly {

RELUME_HD inline Lobe& add(Bsdf& bsdf, LobeKind kind, const Microfacet& microfacet) {
  Lobe& lobe = bsdf.lobes[bsdf.lobe_count++];
  lobe.kind = kind;
  lobe.model = microfacet.model;
  lobe.alpha = microfacet.alpha;
  lobe.weight = 1.0f;
  return lobe;
}

/// Multiple scattering below this mean share of light is omitted. The limit is small because at grazing angles the loss
/// is a hundred times the mean.
inline constexpr float kNegligibleMultipleScattering = 1e-5f;

RELUME_HD inline void add_clearcoat(Bsdf& bsdf, const MaterialSample& m, MicrofacetModel model) {
  const Microfacet microfacet{model, sqr(m.clearcoat_roughness)};
  Lobe& lobe = add(bsdf, microfacet.smooth() ? LobeKind::specular_reflection : LobeKind::reflection, microfacet);
  lobe.color = Rgb(0.04f);
  lobe.f90 = 1;
  lobe.weight = m.clearcoat;
  bsdf.coat = m.clearcoat;
}

RELUME_HD inline Lobe& add_reflection(Bsdf& bsdf, const Rgb& f0, float f90, const Microfacet& microfacet) {
  Lobe& lobe = add(bsdf, microfacet.smooth() ? LobeKind::specular_reflection : LobeKind::reflection, microfacet);
  lobe.color = f0;
  lobe.f90 = f90;
  return lobe;
}

/// Adds multiple scattering between the microfacets of a metal. `average`: mean albedo of single scattering for F = 1.
/// Returns nullptr if it is negligible.
RELUME_HD inline Lobe* add_multiple_reflection(Bsdf& bsdf, const Rgb& f0, float metallic, float average,
                                               const Microfacet& microfacet) {
  const Rgb color = multiple_reflection::color(f0, Rgb(1), average) * metallic;
  if (!(luminance(color) * (1.0f - average) > kNegligibleMultipleScattering)) return nullptr;
  Lobe& lobe = add(bsdf, LobeKind::multiple_reflection, microfacet);
  lobe.color = color;
  return &lobe;
}

/// Whether refraction bends light visibly. Otherwise microfacets have no effect, and half vectors are rounding errors.
RELUME_HD inline bool bends(float ior) { return std::fabs(ior - 1.0f) > 1e-3f; }

/// Index beyond the surface over that on the viewer's side, for a material with a volume.
RELUME_HD inline float relative_index(float ior, bool front_face) { return front_face ? ior : 1.0f / ior; }

/// The interface of a material, with F0 and F90 of its dielectric part.
RELUME_HD inline Interface interface_of(const MaterialSample& m, const MaterialData& material, const Rgb& f0, float f90,
                                        bool front_face) {
  return {f0, f90, material.volume ? relative_index(m.ior, front_face) : 1.0f};
}

RELUME_HD inline Lobe& add_transmission(Bsdf& bsdf, const MaterialSample& m, const MaterialData& material, float weight,
                                        const Microfacet& microfacet) {
  const Microfacet interface { microfacet.model, bends(m.ior) ? microfacet.alpha : 0.0f };
  const LobeKind refracting = interface.smooth() ? LobeKind::smooth_dielectric : LobeKind::dielectric;
  const LobeKind passing = microfacet.smooth() ? LobeKind::null : LobeKind::thin_transmission;
  Lobe& lobe = material.volume ? add(bsdf, refracting, interface) : add(bsdf, passing, microfacet);
  lobe.color = m.base_color;
  lobe.weight = weight;
  return lobe;
}

/// Shares of the light between the bases under the interface.
struct BaseShares {
  float transparent;
  float diffuse;
  float interface_share;  ///< of the dielectric reflection; a refracting interface has its own reflection
  Rgb dielectric_f0;
  float dielectric_f90;
};

RELUME_HD inline BaseShares base_shares(const MaterialSample& m, const MaterialData& material) {
  BaseShares b;
  b.transparent = (1.0f - m.metallic) * m.transmission;
  b.diffuse = (1.0f - m.metallic) * (1.0f - m.transmission);
  b.interface_share = material.volume ? b.diffuse : 1.0f - m.metallic;  // thin walls share the opaque part's
  b.dielectric_f0 = glm::min(f0_from_ior(material.ior) * m.specular_color, Rgb(1)) * m.specular;
  b.dielectric_f90 = m.specular;
  return b;
}

/// Whether the diffuse base is uncovered and unmixed.
RELUME_HD inline bool is_bare(const MaterialSample& m) {
  return m.specular == 0.0f && m.metallic == 0.0f && m.transmission == 0.0f && m.clearcoat == 0.0f;
}

RELUME_HD inline void add_layers(Bsdf& bsdf, const MaterialSample& m, const MaterialData& material,
                                 const EnergyTables& tables, float cos_theta_o, bool front_face) {
  if (m.clearcoat > 0.0f) add_clearcoat(bsdf, m, material.microfacet_model);

  const Microfacet microfacet{material.microfacet_model, sqr(m.roughness)};
  const BaseShares shares = base_shares(m, material);
  bsdf.interface = interface_of(m, material, shares.dielectric_f0, shares.dielectric_f90, front_face);
  const Rgb f0 = shares.dielectric_f0 * shares.interface_share + m.base_color * m.metallic;
  const float f90 = shares.dielectric_f90 * shares.interface_share + m.metallic;

  const bool covered = m.specular > 0.0f;
  if (!is_black(f0) || f90 != 0.0f) {
    add_reflection(bsdf, f0, f90, microfacet);
    if (m.metallic > 0.0f && !microfacet.smooth()) {
      const float average = tables.of(microfacet.model).average_shares(m.roughness).total;
      add_multiple_reflection(bsdf, m.base_color, m.metallic, average, microfacet);
    }
  }
  const Rgb diffuse_albedo = m.base_color * shares.diffuse;
  if (!is_black(diffuse_albedo)) {
    Lobe& lobe = add(bsdf, covered ? LobeKind::covered_lambert : LobeKind::lambert, microfacet);
    lobe.color = diffuse_albedo;
  }
  if (shares.transparent > 0.0f) add_transmission(bsdf, m, material, shares.transparent, microfacet);
  prepare(bsdf, cos_theta_o);
}

}  // namespace bsdf_assembly

/// Builds the lobes of a point seen at `cos_theta_o` > 0. The dielectric part of the material is an interface over a
/// diffuse base or, by the share `transmission`, over a transparent one. Metallic blends towards a metal whose F0 is
/// the base colour. Refraction uses the index of `m`. Reflectance at normal incidence is that of `material`, the same
/// at all wavelengths.
RELUME_HD inline void make_bsdf(Bsdf& bsdf, const MaterialSample& m, const MaterialData& material,
                                const EnergyTables& tables, float cos_theta_o, bool front_face) {
  using namespace bsdf_assembly;
  clear(bsdf);
  bsdf.tables = &tables;
  if (!is_bare(m)) {
    add_layers(bsdf, m, material, tables, cos_theta_o, front_face);
  } else if (!is_black(m.base_color)) {
    Lobe& lobe = add(bsdf, LobeKind::lambert, {material.microfacet_model, sqr(m.roughness)});
    lobe.color = m.base_color;
    lobe.probability = 1.0f;
  }
}

}  // namespace relume
