// The sRGB transfer function (IEC 61966-2-1) between linear light and display values, both in [0, 1].
#pragma once

#include "core/math.h"
#include "core/vec.h"

namespace relume {

/// Display value of linear light; negative values and NaN give 0, values above 1 follow the curve.
RELUME_HD inline float srgb_from_linear(float x) {
  if (!(x > 0.0f)) return 0.0f;
  return x <= 0.0031308f ? 12.92f * x : 1.055f * math::pow(x, 1.0f / 2.4f) - 0.055f;
}

/// Linear light of a display value; negative values and NaN give 0.
RELUME_HD inline float linear_from_srgb(float x) {
  if (!(x > 0.0f)) return 0.0f;
  return x <= 0.04045f ? x / 12.92f : math::pow((x + 0.055f) / 1.055f, 2.4f);
}

RELUME_HD inline Rgb srgb_from_linear(const Rgb& c) {
  return {srgb_from_linear(c.r), srgb_from_linear(c.g), srgb_from_linear(c.b)};
}
RELUME_HD inline Rgb linear_from_srgb(const Rgb& c) {
  return {linear_from_srgb(c.r), linear_from_srgb(c.g), linear_from_srgb(c.b)};
}

/// Nearest of the 256 steps of [0, 1]; values outside are clamped, NaN gives 0.
RELUME_HD inline uint8_t quantise_unorm8(float x) {
  if (!(x > 0.0f)) return 0;
  return static_cast<uint8_t>((x < 1.0f ? x : 1.0f) * 255.0f + 0.5f);
}

}  // namespace relume
