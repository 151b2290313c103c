// One lobe of a BSDF: a closed list of kinds that share one set of parameters. Directions are local (+Z is the shading
// normal on the side of wo, so wo.z > 0). Each kind has its header with eval, pdf and sample; bsdf.h switches.
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
  thin_transmission,     ///< through a rough thin wall, not refracted
  null,                  ///< delta transmission without refraction
  sheen,                 ///< off the fibres of cloth
  diffuse_transmission,  ///< diffuse, to the other side of a thin sheet
};
inline constexpr int kLobeKindCount = 11;

/// Properties of a kind of lobe.
struct LobeTraits {
  bool delta;      ///< scatters into single directions, and has no value elsewhere
  bool glossy;     ///< as wide as its microfacets are rough
  bool transmits;  ///< takes light from the other side
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

/// One bit for each kind that has a trait, so that kernels test a bit instead of reading a table.
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
/// Reflects or transmits an image of the surroundings, sharp or blurred; all other lobes scatter diffusely.
RELUME_HD constexpr bool is_specular(LobeKind kind) { return is_delta(kind) || is_glossy(kind); }
/// Takes light from the other side, in all directions.
RELUME_HD constexpr bool is_rough_transmission(LobeKind kind) { return transmits(kind) && !is_delta(kind); }

/// Lobes of microfacets with an α below this count as mirrors: what they show is an image, not a shade, and another as
/// soon as the eye moves ([Schalk18] §3.2).
inline constexpr float kNarrowAlpha = 0.01f;

/// Which way radiance flows. Refraction scales radiance, not importance ([Veach97], §5.2).
enum class TransportMode : uint8_t { radiance, importance };

/// Radiance is compressed into a smaller solid angle where it enters a denser medium; importance is not. `eta`: of
/// Lobe.
RELUME_HD inline float transport_scale(float eta, TransportMode mode) {
  return mode == TransportMode::radiance ? 1.0f / (eta * eta) : 1.0f;
}

/// No member has a default: a surface point holds several lobes, and clearing them would cost more than a ray.
struct Lobe {
  LobeKind kind;
  FilmBase film;  ///< of layered BSDFs. none: Fresnel's term follows f0 and f90; else the film of InterfaceDetail lies
                  ///< over this
  bool anisotropic;  ///< of layered BSDFs: the microfacets are those of InterfaceDetail; `microfacet` is their
                     ///< geometric mean
  Microfacet microfacet;
  float eta;          ///< of what transmits: index beyond over index on wo's side
  Rgb color;          ///< diffuse albedo; tint of what is transmitted; multiple_reflection: F_ms of [Kulla17]
  Rgb f0;             ///< reflectance from the front; below an interface: of that; below a film: film_f0_bound()
  Rgb f90;            ///< and at grazing angles
  float weight;       ///< share of the mixture that this lobe stands for
  float probability;  ///< with which sampling chooses this lobe
};

/// What it reflects or transmits is an image: it is a delta lobe or narrower than kNarrowAlpha.
RELUME_HD constexpr bool is_narrow(const Lobe& lobe) {
  return is_delta(lobe.kind) || (is_glossy(lobe.kind) && lobe.microfacet.alpha < kNarrowAlpha);
}

/// Parameters that the lobes of a layered BSDF share; filled where a lobe needs them.
struct InterfaceDetail {
  AnisotropicGgx anisotropy;
  ThinFilm film;
  Vec3 coat_normal;  ///< unit, local: of a clearcoat that differs from the base normal
};

/// Fresnel's term of lobes that reflect off the outside. `kLayered`, here and in the functions of lobes: of a layered
/// BSDF, whose lobes may be iridescent or anisotropic; code for the others does not ask.
template <bool kLayered>
RELUME_HD inline Rgb fresnel(const Lobe& lobe, const InterfaceDetail& detail, float cos_theta) {
  if (kLayered && lobe.film != FilmBase::none) return film_reflectance(detail.film, lobe.film, cos_theta);
  return fresnel_schlick(lobe.f0, lobe.f90, cos_theta);
}

/// Value and density of a lobe for one pair of directions.
struct LobeEval {
  Rgb f{0};         ///< BSDF, without cosine, 1/sr
  float pdf_w = 0;  ///< of wi given wo
};

struct LobeSample {
  Vec3 wi{0};
  Rgb weight{0};  ///< delta lobes: f·cos / pdf
  bool valid = false;
};

}  // namespace relume
