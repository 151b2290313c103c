// Error metrics of an image against a reference.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "relume/image.h"
#include "relume/lab/flip.h"
#include "relume/tone_map.h"

namespace relume {

/// Throws Error unless both images have the same size and at least one pixel.
void check_same_size(const Image& a, const Image& b);

/// Added to the denominators of relative errors, so that black references do not dominate them.
inline constexpr double kRelativeEpsilon = 0.01;

/// Means over all pixels and over R, G and B of linear values: image a against reference b. Pixels with a non-finite
/// channel in either image are excluded and counted.
struct Metrics {
  double mse = 0;       ///< (a - b)²
  double rel_mse = 0;   ///< (a - b)² / (b² + 0.01)
  double mae = 0;       ///< |a - b|
  double mape = 0;      ///< |a - b| / (|b| + 0.01)
  double flip = 0;      ///< mean of flip_map() after exposure and tone mapping, [0, 1]; 0 unless requested
  double hdr_flip = 0;  ///< mean of hdr_flip_map(), [0, 1]; 0 unless requested
  std::array<double, 3> mean_a{};
  std::array<double, 3> mean_b{};
  uint64_t pixels = 0;       ///< compared pixels
  uint64_t nonfinite_a = 0;  ///< pixels
  uint64_t nonfinite_b = 0;
};

struct MetricOptions {
  ToneMap tone_map = ToneMap::none;  ///< display transform for FLIP
  float exposure = 0;                ///< stops
  float pixels_per_degree = kDefaultPixelsPerDegree;
  bool flip = true;
  bool hdr_flip = false;  ///< takes about ten times as long as the rest
};

/// Computes the metrics, independent of the number of threads. Throws Error if the sizes differ or no pixel is finite
/// in both images.
Metrics compute_metrics(const Image& a, const Image& b, const MetricOptions& options = {});

/// A measured MSE minus the contribution of the reference's noise. Limited to at least a tenth of the measured MSE: by
/// chance the difference may be negative, which has no ratio or logarithm.
double without_noise(double mse, double reference_mse);

/// Maps values in [0, 1] to colours from black over purple and orange to light yellow (matplotlib's magma map).
/// Display-linear, ready for write_image(). NaN becomes green.
Image color_map(std::span<const float> values, int width, int height);

/// Per-pixel mean over the channels of (a - b)² / (b² + 0.01), for color_map().
std::vector<float> relative_error_map(const Image& a, const Image& b);

}  // namespace relume

namespace relume::lab {
using relume::compute_metrics;
using relume::MetricOptions;
using relume::Metrics;
}  // namespace relume::lab
