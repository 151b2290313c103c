// Demodulation of a vertex: cells store reflected radiance divided by the albedo, so textures stay sharp under a filter
// ([Schipek22 eq. 2.15]).
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Minimum of diffuse colours where radiance is divided by the albedo. With a raised colour, a black texel samples its
/// incident light. The product with the true albedo stays black.
inline constexpr float kSmallestDiffuseColor = 1e-3f;
/// α below which lobes are glossy: keys may distinguish the direction to the viewer.
inline constexpr float kGlossyAlpha = 0.25f;

/// The components that are positive; 1 in place of the others. A divisor.
RELUME_HD inline Rgb positive_or_one(const Rgb& x) {
  return {x.r > 0.0f ? x.r : 1.0f, x.g > 0.0f ? x.g : 1.0f, x.b > 0.0f ? x.b : 1.0f};
}

/// Albedos of a vertex. Delta lobes are excluded, because their light is never filtered.
struct Demodulation {
  Rgb albedo{0};           ///< ρ: directional albedo of all lobes except delta ones
  Rgb raised{0};           ///< ρ': the same with raised diffuse colours
  bool filtered = false;   ///< whether the vertex may be filtered: narrow lobes reflect at most half
  bool glossy = false;     ///< whether a lobe is glossy
  bool has_delta = false;  ///< whether delta lobes exist, which stay outside the cell
  float roughness = 1;     ///< mean roughness of all lobes except delta ones, weighted by albedo; diffuse: 1
  Rgb specular{0};         ///< part of `albedo` and of `raised` from specular lobes

  /// Divisor of radiance: ρ', or 1 in channels where only delta lobes reflect.
  RELUME_HD Rgb divisor() const { return positive_or_one(raised); }
};

/// Colour of a diffuse lobe, raised so that radiance can be divided by it.
RELUME_HD inline Rgb raised_color(const Rgb& color) { return glm::max(color, Rgb(kSmallestDiffuseColor)); }

RELUME_HD inline Rgb raised_albedo(Lobe lobe, const Bsdf& bsdf, float cos_theta_o) {
  lobe.color = raised_color(lobe.color);
  return lobe_albedo(lobe, bsdf.interface, *bsdf.tables, cos_theta_o);
}

/// Albedos of `bsdf`. Lobes with α below `narrow_alpha` are narrow: a filter would blur their reflections. If they
/// reflect more than half, the vertex is not filtered.
RELUME_HD inline Demodulation demodulation_of(const Bsdf& bsdf, float cos_theta_o, float narrow_alpha) {
  if (is_lambert(bsdf)) {
    const Lobe& lobe = bsdf.lobes[0];
    return {lobe.color * lobe.weight, raised_color(lobe.color) * lobe.weight, true, false, false};
  }
  Demodulation d;
  float narrow = 0;
  float total = 0;
  float rough = 0;
  const LayerTransmittance layers = layer_transmittance(bsdf, cos_theta_o);
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const Lobe& lobe = bsdf.lobes[i];
    const float share = layers.to(bsdf, i);
    const Rgb albedo = lobe_albedo(lobe, bsdf.interface, *bsdf.tables, cos_theta_o) * share;
    const bool microfacets = is_glossy(lobe.kind);
    const bool delta = is_delta(lobe.kind);
    total += luminance(albedo);
    if (delta || (microfacets && lobe.alpha < narrow_alpha)) narrow += luminance(albedo);
    d.has_delta = d.has_delta || delta;
    if (delta) continue;
    d.albedo += albedo;
    if (microfacets) d.specular += albedo;
    rough += luminance(albedo) * (microfacets ? std::sqrt(relume::min(lobe.alpha, 1.0f)) : 1.0f);
    d.glossy = d.glossy || (microfacets && lobe.alpha < kGlossyAlpha);
    d.raised += microfacets ? albedo : raised_albedo(lobe, bsdf, cos_theta_o) * share;
  }
  if (const float filtered = luminance(d.albedo); filtered > 0.0f) d.roughness = rough / filtered;
  d.filtered = max_component(d.albedo) > 0.0f && narrow * 2.0f <= total;
  return d;
}

/// Demodulates `bsdf`: the same, and raises its diffuse colours to match if the vertex is filtered.
RELUME_HD inline Demodulation demodulate(Bsdf& bsdf, float cos_theta_o, float narrow_alpha) {
  const Demodulation d = demodulation_of(bsdf, cos_theta_o, narrow_alpha);
  for (int i = 0; d.filtered && i < bsdf.lobe_count; ++i) {
    Lobe& lobe = bsdf.lobes[i];
    if (!is_delta(lobe.kind) && !is_glossy(lobe.kind)) lobe.color = raised_color(lobe.color);
  }
  return d;
}

}  // namespace relume
