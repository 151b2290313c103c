// Maps scene radiance to display values: exposure, then a tone curve.
#pragma once

#include "core/math.h"
#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume {

/// Largest input of the curves. Larger values, including infinity, are white under every curve; squares of this value
/// stay finite.
inline constexpr float kToneMapMax = 1e9f;

namespace detail {

/// Clamps to the domain of the curves; NaN and negative values become 0.
RELUME_HD inline float tone_map_domain(float x) { return x > 0.0f ? (x < kToneMapMax ? x : kToneMapMax) : 0.0f; }

RELUME_HD inline Rgb saturate(const Rgb& c) {
  return {relume::saturate(c.r), relume::saturate(c.g), relume::saturate(c.b)};
}

RELUME_HD inline float aces_curve(float v) {
  return (v * (v + 0.0245786f) - 0.000090537f) / (v * (0.983729f * v + 0.4329510f) + 0.238081f);
}

/// [Wrensch23]: least-squares sixth-degree polynomial of AgX's contrast curve over the encoded range [0, 1].
RELUME_HD inline float agx_contrast(float x) {
  const float p = ((((15.5f * x - 40.14f) * x + 31.96f) * x - 6.868f) * x + 0.4298f) * x + 0.1191f;
  return p * x - 0.00232f;
}

}  // namespace detail

/// Reinhard's global operator on the luminance; preserves chromaticity until a channel reaches 1.
RELUME_HD inline Rgb tone_map_reinhard(const Rgb& c) { return detail::saturate(c / (1.0f + luminance(c))); }

/// Converts to the rendering primaries, applies Hill's rational fit, and converts back. Middle grey 0.18 becomes
/// 0.1055.
RELUME_HD inline Rgb tone_map_aces(const Rgb& c) {
  // Columns; the first matrix is Rec. 709 → AP1 with RRT desaturation, the second ODT desaturation → Rec. 709.
  const Mat3 input(0.59719f, 0.07600f, 0.02840f, 0.35458f, 0.90834f, 0.13383f, 0.04823f, 0.01566f, 0.83777f);
  const Mat3 output(1.60475f, -0.10208f, -0.00327f, -0.53108f, 1.10813f, -0.07276f, -0.07367f, -0.00605f, 1.07602f);
  const Rgb v = input * c;
  return detail::saturate(output * Rgb(detail::aces_curve(v.r), detail::aces_curve(v.g), detail::aces_curve(v.b)));
}

/// Applies the inset matrix, log2 encoding over 16.5 stops, the contrast curve and the outset matrix. The curve's
/// output is for a display with exponent 2.2, hence the final conversion to linear.
RELUME_HD inline Rgb tone_map_agx(const Rgb& c) {
  constexpr float kMinEv = -12.47393f;
  constexpr float kMaxEv = 4.026069f;
  const Mat3 inset(0.842479062253094f, 0.0423282422610123f, 0.0423756549057051f,  //
                   0.0784335999999992f, 0.878468636469772f, 0.0784336f,           //
                   0.0792237451477643f, 0.0791661274605434f, 0.879142973793104f);
  const Mat3 outset(1.19687900512017f, -0.0528968517574562f, -0.0529716355144438f,  //
                    -0.0980208811401368f, 1.15190312990417f, -0.0980434501171241f,  //
                    -0.0990297440797205f, -0.0989611768448433f, 1.15107367264116f);
  Rgb v = inset * c;
  for (int i = 0; i < 3; ++i) {
    const float ev = math::log2(v[i] > 1e-10f ? v[i] : 1e-10f);
    v[i] = detail::agx_contrast(saturate((ev - kMinEv) / (kMaxEv - kMinEv)));
  }
  v = outset * v;
  for (int i = 0; i < 3; ++i) v[i] = math::pow(saturate(v[i]), 2.2f);
  return v;
}

/// Subtracts the Fresnel reflection at normal incidence, compresses peaks above 0.76 towards 1, and desaturates
/// compressed colours.
RELUME_HD inline Rgb tone_map_neutral(const Rgb& c) {
  constexpr float kFresnel = 0.04f;
  constexpr float kCompressionStart = 0.8f - kFresnel;
  constexpr float kDesaturation = 0.15f;
  const float low = c.r < c.g ? (c.r < c.b ? c.r : c.b) : (c.g < c.b ? c.g : c.b);
  const Rgb shifted = c - Rgb(low < 2.0f * kFresnel ? low - low * low / (4.0f * kFresnel) : kFresnel);
  const float peak = max_component(shifted);
  if (peak < kCompressionStart) return shifted;
  constexpr float kRoom = 1.0f - kCompressionStart;
  const float compressed = 1.0f - kRoom * kRoom / (peak + kRoom - kCompressionStart);
  const float white = 1.0f - 1.0f / (kDesaturation * (peak - compressed) + 1.0f);
  return detail::saturate(shifted * (compressed / peak) * (1.0f - white) + Rgb(compressed * white));
}

/// Scales radiance by 2^exposure (stops), then applies the curve. NaN and negative channels count as 0, infinity as
/// kToneMapMax. Result in [0, 1], display-linear.
RELUME_HD inline Rgb tone_map(ToneMap curve, float exposure, const Rgb& radiance) {
  const float scale = math::exp2(exposure);
  const Rgb c{detail::tone_map_domain(scale * radiance.r), detail::tone_map_domain(scale * radiance.g),
              detail::tone_map_domain(scale * radiance.b)};
  switch (curve) {
    case ToneMap::reinhard: return tone_map_reinhard(c);
    case ToneMap::aces: return tone_map_aces(c);
    case ToneMap::agx: return tone_map_agx(c);
    case ToneMap::neutral: return tone_map_neutral(c);
    case ToneMap::none: break;
  }
  return detail::saturate(c);
}

}  // namespace relume
