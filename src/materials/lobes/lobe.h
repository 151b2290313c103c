// One lobe of a BSDF: a closed list of kinds with one set of parameters. Directions are local: +Z is the shading normal
// on the side of wo, so wo.z > 0. The header of each kind has eval, pdf and sample; bsdf.h switches between kinds.
#pragma once

#include "materials/energy_tables.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"
#include "materials/thin_film.h"

namespace relume {

enum class LobeKind : uint8_t {
  lambert,               ///< diffuse reflection
  covered_lambert,       ///< diffuse reflection below a dielectric interface
  reflection,            ///< single scattering off microfacets
  multiple_reflection,   ///< multiple scattering between microfacets
  specular_reflection,   ///< delta reflection
  dielectric,            ///< rough interface: reflection and refraction
  smooth_dielectric,     ///< delta reflection and refraction
  thin_transmission,     ///< transmission through a rough thin wall, not refracted
  null,                  ///< delta transmission without refraction
  sheen,                 ///< reflection off fibres of cloth
  diffuse_transmission,  ///< diffuse transmission to the other side of a thin sheet
};
inline constexpr int kLobeKindCount = 11;

/// Properties of a kind of lobe.
struct LobeTraits {
  bool delta;      ///< scatters into single directions; zero elsewhere
  bool glossy;     ///< as wide as the roughness of its microfacets
  bool transmits;  ///< transmits light from the other side
  bool refracts;   ///< transmits along a refracted direction
};

/// In the order of LobeKind.
inline constexpr LobeTraits kLobeTraits[kLobeKindCount] = {
    {false, false, false, false},  // lambert
    {false, false, false, false},  // covered_lambert
    {false, true, false, false},   // reflection
    {false, false, false, false},  // multiple_reflection
    {true, false, false, false},   // specular_reflection
    {false, true, true, true},     // dielectric
    {true, false, true, true},     // smooth_dielectric
    {false, true, true, false},    // thin_transmission
    {true, false, true, false},    // null
    {false, false, false, false},  // sheen
    {false, false, true, false},   // diffuse_transmission
};

/// Mask of the kinds that have a trait. Kernels test a bit instead of reading a table.
constexpr uint32_t lobes_with(bool LobeTraits::*trait) {
  uint32_t bits = 0;
  for (uint32_t kind = 0; kind < kLobeKindCount; ++kind) bits |= kLobeTraits[kind].*trait ? 1u << kind : 0u;
  return bits;
}

template <uint32_t kKinds>
RELUME_HD constexpr bool is_among(LobeKind kind) {
  return (kKinds >> static_cast<uint32_t>(kind) & 1u) != 0u;
}

RELUME_HD constexpr bool is_delta(LobeKind kind) { return is_among<lobes_with(&LobeTraits::delta)>(kind); }
RELUME_HD constexpr bool is_glossy(LobeKind kind) { return is_among<lobes_with(&LobeTraits::glossy)>(kind); }
RELUME_HD constexpr bool transmits(LobeKind kind) { return is_among<lobes_with(&LobeTraits::transmits)>(kind); }
RELUME_HD constexpr bool refracts(LobeKind kind) { return is_among<lobes_with(&LobeTraits::refracts)>(kind); }
/// Whether the lobe reflects or transmits an image of the surroundings, sharp or blurred. All other lobes are diffuse.
RELUME_HD constexpr bool is_specular(LobeKind kind) { return is_delta(kind) || is_glossy(kind); }
/// Whether the lobe transmits light from the other side in all directions.
RELUME_HD constexpr bool is_rough_transmission(LobeKind kind) { return transmits(kind) && !is_delta(kind); }

/// Microfacet lobes with a lower α count as mirrors. Their reflections are images that change with the viewpoint
/// ([Schalk18] §3.2).
inline constexpr float kNarrowAlpha = 0.01f;

/// Direction of transport. Refraction scales radiance, not importance ([Veach97], §5.2).
enum class TransportMode : uint8_t { radiance, importance };

/// Factor of refraction: radiance is compressed into a smaller solid angle in a denser medium, importance is not.
/// `eta`: of Interface.
RELUME_HD inline float transport_scale(float eta, TransportMode mode) {
  return mode == TransportMode::radiance ? 1.0f / (eta * eta) : 1.0f;
}

/// Members have no defaults: a surface point has several lobes, and clearing them would cost more than a ray.
struct Lobe {
  LobeKind kind;
  FilmBase film;     ///< of layered BSDFs: base of the film of InterfaceDetail; none: Fresnel's term follows f0 and f90
  bool anisotropic;  ///< of layered BSDFs: uses InterfaceDetail; `alpha` is the geometric mean of both widths
  MicrofacetModel model;
  float alpha;        ///< of Microfacet
  Rgb color;          ///< diffuse albedo; tint of transmission; multiple_reflection: F_ms of [Kulla17]; reflection and
                      ///< specular_reflection: reflectance at normal incidence, below a film film_f0_bound()
  float f90;          ///< of reflection and specular_reflection: reflectance at grazing angles
  float weight;       ///< share of this lobe in the mixture
  float probability;  ///< probability of sampling this lobe

  RELUME_HD Microfacet microfacet() const { return {model, alpha}; }
};
static_assert(sizeof(Lobe) == 32);

/// The dielectric interface of a surface. Its diffuse lobes lie below it, and its transmitting lobes pass through it.
/// They share one record, because a device's thread stores every lobe in memory.
struct Interface {
  Rgb f0;     ///< reflectance at normal incidence; below a film: film_f0_bound()
  float f90;  ///< reflectance at grazing angles
  float eta;  ///< index beyond over index on wo's side; 1 if it does not refract
};

/// The interface from its other side.
RELUME_HD inline void flip(Interface& interface) { interface.eta = 1.0f / interface.eta; }
RELUME_HD inline Interface flipped(Interface interface) {
  flip(interface);
  return interface;
}

/// Whether the lobe shows an image: a delta lobe, or narrower than kNarrowAlpha.
RELUME_HD constexpr bool is_narrow(const Lobe& lobe) {
  return is_delta(lobe.kind) || (is_glossy(lobe.kind) && lobe.alpha < kNarrowAlpha);
}

/// Parameters shared by the lobes of a layered BSDF, filled only where a lobe needs them.
struct InterfaceDetail {
  AnisotropicGgx anisotropy;
  ThinFilm film;
  Vec3 coat_normal;  ///< unit, local: of a clearcoat with separate normals
};

/// Fresnel's term of reflection and specular_reflection. `kLayered`, here and in the functions of lobes, marks layered
/// BSDFs. Only these test for iridescent and anisotropic lobes.
template <bool kLayered>
RELUME_HD inline Rgb fresnel(const Lobe& lobe, const InterfaceDetail& detail, float cos_theta) {
  if (kLayered && lobe.film != FilmBase::none) return film_reflectance(detail.film, lobe.film, cos_theta);
  return fresnel_schlick(lobe.color, Rgb(lobe.f90), cos_theta);
}

/// Fresnel's term of a lobe that passes through a thin interface.
template <bool kLayered>
RELUME_HD inline Rgb fresnel(const Lobe& lobe, const Interface& interface, const InterfaceDetail& detail,
                             float cos_theta) {
  if (kLayered && lobe.film != FilmBase::none) return film_reflectance(detail.film, lobe.film, cos_theta);
  return fresnel_schlick(interface.f0, Rgb(interface.f90), cos_theta);
}

/// Value and density of a lobe for one pair of directions.
struct LobeEval {
  Rgb f{0};         ///< BSDF, without cosine, 1/sr
  float pdf_w = 0;  ///< density of wi given wo
};

struct LobeSample {
  Vec3 wi{0};
  Rgb weight{0};  ///< delta lobes: f·cos / pdf
  bool valid = false;
};

}  // namespace relume
