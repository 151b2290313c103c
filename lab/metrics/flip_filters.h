// The two filter stages of FLIP as separable convolutions.
#pragma once

#include <functional>
#include <vector>

#include "core/vec.h"

namespace relume::detail {

/// Calls `function` for each row, in parallel.
void for_each_row(int height, const std::function<void(int)>& function);

/// [Andersson20 eq. 4-5]: contrast sensitivity of the achromatic, red-green and blue-yellow channels as sums of
/// Gaussians. Each tap is one vector (achromatic, red-green, first and second Gaussian of blue-yellow).
struct ContrastKernel {
  int radius = 0;
  std::vector<Vec4> taps;  ///< 2 · radius + 1, each component sums to 1
  float yellow_first = 1;  ///< weights of the two blue-yellow Gaussians, sum 1
  float yellow_second = 0;
};
ContrastKernel contrast_kernel(float pixels_per_degree);

/// [Andersson20 §4.2]: (Gaussian, first derivative, second derivative). The Gaussian sums to 1. The positive and
/// negative weights of the derivatives sum to 1 and -1.
struct FeatureKernel {
  int radius = 0;
  std::vector<Vec3> taps;
};
FeatureKernel feature_kernel(float pixels_per_degree);

/// Filters `opponent` (Y, Cx, Cz per pixel) by the contrast sensitivity of the eye; borders are replicated.
std::vector<Vec3> filter_contrast(const std::vector<Vec3>& opponent, int width, int height,
                                  const ContrastKernel& kernel);

/// Strength of edges (x) and points (y) in a luminance image with range [0, 1].
std::vector<Vec2> detect_features(const std::vector<float>& luminance, int width, int height,
                                  const FeatureKernel& kernel);

}  // namespace relume::detail
