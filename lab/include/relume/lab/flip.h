// FLIP: the difference that a viewer sees when two images alternate in place ([Andersson20]; HDR: [Andersson21]).
#pragma once

#include <vector>

#include "relume/image.h"

namespace relume {

/// A display of 0.7 m and 3840 pixels width seen from 0.7 m ([Andersson20 §3]).
inline constexpr float kDefaultPixelsPerDegree = 67.0f;

/// Per-pixel difference in [0, 1] of two images of one size as a display shows them: linear, clamped to [0, 1].
/// Non-finite channels count as black. Throws Error if the sizes differ.
std::vector<float> flip_map(const Image& test, const Image& reference,
                            float pixels_per_degree = kDefaultPixelsPerDegree);

/// Exposures, in stops, at which HDR-FLIP looks; count ≥ 2.
struct FlipExposures {
  float start = 0;
  float stop = 0;
  int count = 2;
};

/// From the reference's brightest pixel and its median luminance: at `start` the first, at `stop` the second comes out
/// at 85 % of white ([Andersson21 §4]). Guards that the paper does not need: luminance is at most 65536, and dark
/// medians extend the range by at most 30 stops.
FlipExposures flip_exposures(const Image& reference);

/// Largest flip_map() over the exposures, tone-mapped with Narkowicz's fit of ACES as the paper has it (not the fit of
/// ToneMap::aces, so that figures can be compared with published ones).
std::vector<float> hdr_flip_map(const Image& test, const Image& reference, const FlipExposures& exposures,
                                float pixels_per_degree = kDefaultPixelsPerDegree);

}  // namespace relume

namespace relume::lab {
using relume::flip_map;
using relume::hdr_flip_map;
}  // namespace relume::lab
