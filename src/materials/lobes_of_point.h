// The lobes of one surface point, and questions about them that need no directions.
#pragma once

#include <cstddef>

#include "materials/lobes/lobe.h"

namespace relume {

inline constexpr int kMaxLobes = 8;

struct BsdfEval {
  Rgb f{0};               ///< 1/sr
  float pdf_forward = 0;  ///< density of wi given wo, excluding delta lobes
  float pdf_reverse = 0;  ///< density of wo given wi; only from eval_pdf<true>
};

struct BsdfSample {
  Vec3 wi{0};
  Rgb weight{0};        ///< f · |cos θ| / pdf; zero ends the path
  float pdf_w = 0;      ///< density of the whole mixture; undefined for delta
  float alpha = 1;      ///< width of the chosen lobe (diffuse: 1), for ray cones
  float eta_scale = 1;  ///< factor 1/η² of refraction within `weight`, which does not change the energy
  bool delta = false;
  bool valid = false;
  float guide_pdf_w = 0;  ///< density of the guiding distribution alone, if it is part of `pdf_w`
  float bsdf_pdf_w = 0;   ///< density of the BSDF alone, if `pdf_w` includes guiding
  float resampling = 1;   ///< factor of resampling in `weight`, which is then f · |cos θ| / pdf times it

  RELUME_HD bool transmitted() const { return wi.z < 0.0f; }
};

/// Lobes of one surface point, prepared for wo. Those of make_bsdf() use the first 200 bytes only.
struct Bsdf {
  const EnergyTables* tables;  ///< a member of the kernel's SceneView, which must outlive the BSDF
  int lobe_count;
  float coat;             ///< weight of the clearcoat over lobes 1 …; lobe 0 is then the coat
  bool layered;           ///< whether `sheen` and `detail` are used; set by make_layered_bsdf() only
  bool coat_has_normal;   ///< layered: the coat has the normal detail.coat_normal
  Interface interface;    ///< of its diffuse and transmitting lobes
  Lobe lobes[kMaxLobes];  ///< lobe_count valid elements
  float sheen;            ///< largest component of the sheen colour, above all later lobes; 0: none
  InterfaceDetail detail;

  RELUME_HD bool empty() const { return lobe_count == 0; }
  RELUME_HD bool has_coat() const { return coat > 0.0f; }
  RELUME_HD bool has_sheen() const { return layered && sheen > 0.0f; }
  RELUME_HD bool is_coat(int lobe) const { return lobe == 0 && has_coat(); }
  RELUME_HD int sheen_lobe() const { return has_coat() ? 1 : 0; }  ///< if has_sheen()
};

/// Maximum number of lobes from make_bsdf(): coat, reflection, multiple reflection, diffuse base, transmission.
inline constexpr int kMaxPlainLobes = 5;
static_assert(offsetof(Bsdf, lobes) + kMaxPlainLobes * sizeof(Lobe) <= 200);

/// Removes all lobes and the interface.
RELUME_HD inline void clear(Bsdf& bsdf) {
  bsdf.lobe_count = 0;
  bsdf.coat = 0;
  bsdf.layered = false;
  bsdf.interface = {Rgb(0), 0.0f, 1.0f};
}

enum class SpecularLobes : uint8_t { none, some, all };

/// Whether none, some or all lobes are specular; none in an empty BSDF.
RELUME_HD inline SpecularLobes specular_lobes(const Bsdf& bsdf) {
  int count = 0;
  for (int i = 0; i < bsdf.lobe_count; ++i) count += is_specular(bsdf.lobes[i].kind) ? 1 : 0;
  if (count == 0) return SpecularLobes::none;
  return count == bsdf.lobe_count ? SpecularLobes::all : SpecularLobes::some;
}

/// Whether any lobe can be evaluated, as next event estimation requires.
RELUME_HD inline bool has_non_delta(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (!is_delta(bsdf.lobes[i].kind)) return true;
  }
  return false;
}

/// α of the narrowest glossy lobe; 1 without any.
RELUME_HD inline float narrowest_alpha(const Bsdf& bsdf) {
  float alpha = 1.0f;
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (is_glossy(bsdf.lobes[i].kind)) alpha = relume::min(alpha, bsdf.lobes[i].alpha);
  }
  return alpha;
}

/// Whether any lobe is glossy.
RELUME_HD inline bool has_glossy(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (is_glossy(bsdf.lobes[i].kind)) return true;
  }
  return false;
}

/// Whether any lobe has one direction only.
RELUME_HD inline bool has_delta(const Bsdf& bsdf) {
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    if (is_delta(bsdf.lobes[i].kind)) return true;
  }
  return false;
}

}  // namespace relume
