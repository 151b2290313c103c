// Dispersion: index of refraction per wavelength (KHR_materials_dispersion), and response of the image channels to a
// wavelength. Wavelengths are in nanometres.
#pragma once

#include <cmath>

#include "core/math.h"
#include "core/vec.h"

namespace relume {

/// No wavelength: light refracts with the index of the material, that of the d line.
inline constexpr float kNoWavelength = 0.0f;
/// Range of the paths' wavelengths.
inline constexpr float kShortestWavelength = 380.0f;
inline constexpr float kLongestWavelength = 780.0f;

/// Index of refraction at `wavelength_nm`: Cauchy's equation with two terms, as in KHR_materials_dispersion. `ior`:
/// index at the d line, 587.56 nm. `dispersion`: 20 over the Abbe number. Returns exactly `ior` if `dispersion` is 0 or
/// without a wavelength.
RELUME_HD inline float index_at(float ior, float dispersion, float wavelength_nm) {
  if (!(dispersion > 0.0f) || wavelength_nm == kNoWavelength) return ior;
  const float growth = 523655.0f / (wavelength_nm * wavelength_nm) - 1.5168f;
  return ior + (ior - 1.0f) * (dispersion / 20.0f) * growth;  // at least 1, because dispersion is at most 20
}

namespace response_detail {

/// A logistic density with its peak, nanometres, and its mass below, above and within the range of wavelengths.
struct Channel {
  float peak;
  float below;
  float above;
  float between;
};

/// Peaks are the dominant wavelengths of the sRGB primaries (IEC 61966-2-1) against its white point.
RELUME_HD inline Channel channel(uint32_t c) {
  if (c == 0) return {611.4f, 2.6115721e-6f, 8.5520693e-5f, 0.99991187f};
  if (c == 1) return {549.1f, 8.3178004e-5f, 2.6851326e-6f, 0.99991414f};
  return {464.2f, 9.2139701e-3f, 2.4018428e-8f, 0.99078601f};
}

/// Scale of the densities, nanometres. Neighbouring channels overlap enough for continuous hues.
inline constexpr float kScale = 18.0f;

RELUME_HD inline float response(const Channel& c, float wavelength_nm) {
  const float e = math::exp(-std::fabs(wavelength_nm - c.peak) / kScale);
  return e / (sqr(1.0f + e) * kScale * c.between);
}

}  // namespace response_detail

/// Response of the red, green and blue channel, per nanometre: logistic densities truncated to the range of
/// wavelengths. Each is positive and integrates to 1. Colour matching functions of RGB primaries have negative lobes,
/// which would make path weights negative.
RELUME_HD inline Rgb channel_response(float wavelength_nm) {
  using namespace response_detail;
  return {response(channel(0), wavelength_nm), response(channel(1), wavelength_nm),
          response(channel(2), wavelength_nm)};
}

/// Density of sample_wavelength(), per nanometre: the mean response of the channels.
RELUME_HD inline float wavelength_pdf(float wavelength_nm) {
  const Rgb s = channel_response(wavelength_nm);
  return (s.r + s.g + s.b) / 3.0f;
}

/// Samples a wavelength with `u` in [0, 1). Each third of that interval is the inverse of one channel's distribution,
/// so stratified numbers stay stratified in all channels.
RELUME_HD inline float sample_wavelength(float u) {
  using namespace response_detail;
  const float scaled = u * 3.0f;
  const uint32_t index = scaled < 1.0f ? 0u : (scaled < 2.0f ? 1u : 2u);
  const Channel c = channel(index);
  const float t = clamp(scaled - static_cast<float>(index), 0.0f, 1.0f);
  const float shorter = c.below + t * c.between;
  const float longer = c.above + (1.0f - t) * c.between;
  return clamp(c.peak + kScale * math::log(shorter / longer), kShortestWavelength, kLongestWavelength);
}

/// Weight of a sampled wavelength per channel: response over density. Its mean is 1 in each channel, and the channels
/// of each weight sum to 3.
RELUME_HD inline Rgb wavelength_weight(float wavelength_nm) {
  const Rgb s = channel_response(wavelength_nm);
  return s * (3.0f / (s.r + s.g + s.b));
}

}  // namespace relume
