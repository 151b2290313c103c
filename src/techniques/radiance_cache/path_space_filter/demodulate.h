// Taking the albedo out of a vertex: cells hold what a surface would reflect if its albedo were one, so textures stay
// sharp under a filter ([Schipek22 eq. 2.15]).
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Diffuse colours below are raised before radiance is divided by the albedo. A black texel says nothing of the light
/// that falls on it; its raised twin does, and the product with the true albedo stays black.
inline constexpr float kSmallestDiffuseColor = 1e-3f;
/// Lobes below this α depend on the direction to the viewer so much that keys may tell directions apart.
inline constexpr float kGlossyAlpha = 0.25f;

/// How a vertex is demodulated. Delta lobes take no part: what they show is never filtered.
struct Demodulation {
  Rgb albedo{0};           ///< ρ: directional albedo of all lobes but delta ones
  Rgb raised{0};           ///< ρ': the same with raised diffuse colours
  bool filtered = false;   ///< whether the vertex may be filtered at all: narrow lobes reflect at most half
  bool glossy = false;     ///< some lobe is glossy
  bool has_delta = false;  ///< there are delta lobes, which stay outside the cell

  /// What radiance is divided by: ρ', 1 where nothing is reflected but what delta lobes show.
  RELUME_HD Rgb divisor() const {
    const auto positive = [](float x) { return x > 0.0f ? x : 1.0f; };
    return {positive(raised.r), positive(raised.g), positive(raised.b)};
  }
};

/// Colour of a diffuse lobe that radiance may be divided by.
RELUME_HD inline Rgb raised_color(const Rgb& color) { return glm::max(color, Rgb(kSmallestDiffuseColor)); }

RELUME_HD inline Rgb raised_albedo(Lobe lobe, const EnergyTables& tables, float cos_theta_o) {
  lobe.color = raised_color(lobe.color);
  return lobe_albedo(lobe, tables, cos_theta_o);
}

/// Demodulates `bsdf` and raises its diffuse colours to match. Lobes whose α is below `narrow_alpha` are narrow: a
/// filter would blur what they show. Where they reflect more than half, the vertex is not filtered and stays as it is.
RELUME_HD inline Demodulation demodulate(Bsdf& bsdf, float cos_theta_o, float narrow_alpha) {
  if (is_lambert(bsdf)) {
    Lobe& lobe = bsdf.lobes[0];
    const Rgb albedo = lobe.color * lobe.weight;
    lobe.color = raised_color(lobe.color);
    return {albedo, lobe.color * lobe.weight, true, false, false};
  }
  Demodulation d;
  float narrow = 0;
  float total = 0;
  const LayerTransmittance layers = layer_transmittance(bsdf, cos_theta_o);
  for (int i = 0; i < bsdf.lobe_count; ++i) {
    const Lobe& lobe = bsdf.lobes[i];
    const float share = layers.to(bsdf, i);
    const Rgb albedo = lobe_albedo(lobe, *bsdf.tables, cos_theta_o) * share;
    const bool microfacets = is_glossy(lobe.kind);
    const bool delta = is_delta(lobe.kind);
    total += luminance(albedo);
    if (delta || (microfacets && lobe.microfacet.alpha < narrow_alpha)) narrow += luminance(albedo);
    d.has_delta = d.has_delta || delta;
    if (delta) continue;
    d.albedo += albedo;
    d.glossy = d.glossy || (microfacets && lobe.microfacet.alpha < kGlossyAlpha);
    d.raised += microfacets ? albedo : raised_albedo(lobe, *bsdf.tables, cos_theta_o) * share;
  }
  d.filtered = max_component(d.albedo) > 0.0f && narrow * 2.0f <= total;
  for (int i = 0; d.filtered && i < bsdf.lobe_count; ++i) {
    Lobe& lobe = bsdf.lobes[i];
    if (!is_delta(lobe.kind) && !is_glossy(lobe.kind)) lobe.color = raised_color(lobe.color);
  }
  return d;
}

}  // namespace relume
