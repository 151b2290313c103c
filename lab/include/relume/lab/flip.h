// FLIP: the visible difference between two images that alternate in place ([Andersson20]; HDR: [Andersson21]).
#pragma once

#include <vector>

#include "relume/image.h"

namespace relume {

/// A display of 0.7 m and 3840 pixels width viewed from 0.7 m ([Andersson20 §3]).
inline constexpr float kDefaultPixelsPerDegree = 67.0f;

/// Per-pixel difference in [0, 1] of two display images of equal size: linear, clamped to [0, 1]. Non-finite channels
/// count as black. Throws Error if the sizes differ.
std::vector<float> flip_map(const Image& test, const Image& reference,
                            float pixels_per_degree = kDefaultPixelsPerDegree);

/// Exposures of HDR-FLIP, in stops; count ≥ 2.
struct FlipExposures {
  float start = 0;
  float stop = 0;
  int count = 2;
};

/// Exposures from the reference's brightest pixel and its median luminance, mapped to 85 % of white at `start` and
/// `stop`, respectively ([Andersson21 §4]). Additional limits, not in the paper: luminance is at most 65536, and dark
/// medians extend the range by at most 30 stops.
FlipExposures flip_exposures(const Image& reference);

/// Maximum of flip_map() over the exposures, tone-mapped with the paper's fit of ACES by Narkowicz. Not the fit of
/// ToneMap::aces, so results are comparable with published ones.
std::vector<float> hdr_flip_map(const Image& test, const Image& reference, const FlipExposures& exposures,
                                float pixels_per_degree = kDefaultPixelsPerDegree);

}  // namespace relume

namespace relume::lab {
using relume::flip_map;
using relume::hdr_flip_map;
}  // namespace relume::lab
