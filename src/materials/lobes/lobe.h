// One lobe of a BSDF: a closed list of kinds that share one set of parameters. Directions are local (+Z is the shading
// normal on the side of wo, so wo.z > 0). Each kind has its header with eval, pdf and sample; bsdf.h switches.
#pragma once

#include "materials/energy_tables.h"
#include "materials/fresnel.h"
#include "materials/microfacet.h"

namespace relume {

enum class LobeKind : uint8_t {
  lambert,              ///< diffuse reflection
  covered_lambert,      ///< diffuse reflection below a dielectric interface
  reflection,           ///< single scattering off microfacets
  multiple_reflection,  ///< what bounces between microfacets
  mirror,               ///< delta reflection
  dielectric,           ///< rough interface: reflection and refraction
  smooth_dielectric,    ///< delta reflection and refraction
  thin_transmission,    ///< through a rough thin wall, not refracted
  pass_through,         ///< delta, straight on
};
inline constexpr int kLobeKindCount = 9;

/// Lobes of microfacets with an α below this count as mirrors: what they show is an image, not a shade, and another as
/// soon as the eye moves ([Schalk18] §3.2).
inline constexpr float kNarrowAlpha = 0.01f;

/// Which way radiance flows. Refraction scales radiance, not importance ([Veach97], §5.2).
enum class TransportMode : uint8_t { radiance, importance };

/// No member has a default: a surface point holds several lobes, and clearing them would cost more than a ray.
struct Lobe {
  LobeKind kind;
  Microfacet microfacet;
  float eta;          ///< dielectric: index beyond over index on wo's side
  Rgb color;          ///< diffuse albedo; tint of what is transmitted; multiple_reflection: F_ms of [Kulla17]
  Rgb f0;             ///< reflectance from the front; covered_lambert: of the cover
  Rgb f90;            ///< and at grazing angles
  float weight;       ///< share of the mixture that this lobe stands for
  float probability;  ///< with which sampling chooses this lobe
};

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
