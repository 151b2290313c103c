// Exact sums of a pixel's samples, for images whose samples are rendered in parts: sums of disjoint parts add up to
// that of all samples, bit for bit, in any order.
#pragma once

#include <type_traits>

#include "core/fixed_sum.h"
#include "core/vec.h"
#include "framebuffer/pixel_moments.h"

namespace relume {

/// Samples per block. A block is summed in the order of its samples, and blocks are summed exactly, so parts must begin
/// at multiples of it.
inline constexpr uint32_t kBlockSamples = 4;

/// Luminance in double precision, linear in its arguments up to their rounding.
RELUME_HD inline double luminance_of(double r, double g, double b) { return 0.2126 * r + 0.7152 * g + 0.0722 * b; }

/// Sum of the samples of an incomplete block.
struct SampleBlock {
  double r = 0;
  double g = 0;
  double b = 0;
  double square = 0;  ///< of luminance

  RELUME_HD void add(const Rgb& value) {
    const auto red = static_cast<double>(value.r);
    const auto green = static_cast<double>(value.g);
    const auto blue = static_cast<double>(value.b);
    r += red;
    g += green;
    b += blue;
    const double y = luminance_of(red, green, blue);
    square += y * y;
  }
};

/// Sums of radiance. Those of a block are limited to ±2^44 per channel, and to 2^88, its square, for squares.
struct RadianceSums {
  FixedSum<2, 60> r;
  FixedSum<2, 60> g;
  FixedSum<2, 60> b;
  FixedSum<3, 80> square;  ///< of the samples' luminance

  RELUME_HD void add(const SampleBlock& block) {
    r.add(block.r);
    g.add(block.g);
    b.add(block.b);
    square.add(block.square);
  }
  RELUME_HD void add(const RadianceSums& other) {
    r.add(other.r);
    g.add(other.g);
    b.add(other.b);
    square.add(other.square);
  }

  /// Mean of `n` samples; black without any.
  RELUME_HD Rgb mean(uint32_t n) const {
    if (n == 0) return Rgb(0);
    const auto count = static_cast<double>(n);
    return {static_cast<float>(r.value() / count), static_cast<float>(g.value() / count),
            static_cast<float>(b.value() / count)};
  }
  /// Unbiased variance of the mean luminance of `n` samples, as variance_of_mean(); 0 below two samples. Differences of
  /// the order of the rounding error count as none.
  RELUME_HD float variance(uint32_t n, uint32_t correlated) const {
    if (n < 2) return 0.0f;
    const auto count = static_cast<double>(n);
    const double y = luminance_of(r.value(), g.value(), b.value());
    const double squares = square.value();
    const double m2 = squares - y * y / count;
    if (!(m2 > squares * 0x1p-46)) return 0.0f;
    return static_cast<float>(m2 / (count * (count - 1.0)) * correlation_factor(n, correlated));
  }
};

/// Sums of the properties of first hits.
struct SurfaceSums {
  FixedSum<1, 38> albedo[3];
  FixedSum<1, 38> normal[3];
  FixedSum<2, 60> depth;

  /// Adds a sample. Values that are not finite count as 0.
  RELUME_HD void add(const Rgb& a, const Vec3& n, float d) {
    for (int i = 0; i < 3; ++i) {
      albedo[i].add(is_finite(a[i]) ? static_cast<double>(a[i]) : 0.0);
      normal[i].add(is_finite(n[i]) ? static_cast<double>(n[i]) : 0.0);
    }
    depth.add(is_finite(d) ? static_cast<double>(d) : 0.0);
  }
  RELUME_HD void add(const SurfaceSums& other) {
    for (int i = 0; i < 3; ++i) {
      albedo[i].add(other.albedo[i]);
      normal[i].add(other.normal[i]);
    }
    depth.add(other.depth);
  }
};

/// Mean of `n` summands; 0 without any.
template <int words, int fraction_bits>
RELUME_HD float mean_of(const FixedSum<words, fraction_bits>& sum, uint32_t n) {
  return n == 0 ? 0.0f : static_cast<float>(sum.value() / static_cast<double>(n));
}

/// All sums of a pixel.
struct PixelSums {
  RadianceSums radiance;
  uint32_t rays = 0;
  uint32_t nonfinite = 0;  ///< samples that were not finite, which count as black
  SurfaceSums surface;     ///< 0 if the layers of surfaces are not rendered

  void add(const PixelSums& other) {
    radiance.add(other.radiance);
    rays += other.rays;
    nonfinite += other.nonfinite;
    surface.add(other.surface);
  }
};
static_assert(std::is_trivially_copyable_v<PixelSums>);
static_assert(sizeof(PixelSums) == 144, "files hold it as 32-bit words, without gaps");

}  // namespace relume
