// adaptive.method "pooled": samples in proportion to the standard deviation of a pixel's samples, estimated from its
// neighbours. This minimises the sum of squared errors for a given total of samples ([Neyman34], §4).
#pragma once

#include "core/hash.h"
#include "core/math.h"
#include "framebuffer/pixel_moments.h"

namespace relume {

/// Radius of the pool of neighbours: 5×5 pixels.
inline constexpr uint32_t kPoolRadius = 2;

/// Statistics of the samples of one or several pixels.
struct alignas(16) PooledMoments {
  float squares = 0;    ///< Σ over the samples of their squared distance from the pixel's mean, averaged over RGB
  float freedom = 0;    ///< Σ (samples − 1)
  float luminance = 0;  ///< Σ luminance of the pixels' means
  float pixels = 0;

  RELUME_HD void add(const PooledMoments& other) {
    squares += other.squares;
    freedom += other.freedom;
    luminance += other.luminance;
    pixels += other.pixels;
  }
};

/// The pixels [first, last] of a row or column within kPoolRadius of pixel `center`.
struct PoolSpan {
  uint32_t first = 0;
  uint32_t last = 0;

  RELUME_HD PoolSpan(uint32_t center, uint32_t size)
      : first(center < kPoolRadius ? 0 : center - kPoolRadius), last(relume::min(center + kPoolRadius, size - 1)) {}
};

/// Statistics of each pixel's own samples.
struct OwnStatisticsKernel {
  MomentsView history;
  View<PooledMoments> moments;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const PixelMoments own = history[pixel];
    moments[pixel] = own.samples < 2 ? PooledMoments{}
                                     : PooledMoments{own.m2_rgb / 3.0f, static_cast<float>(own.samples - 1),
                                                     luminance(own.mean), 1.0f};
  }
};

/// First of two separable passes over the pool: sums along rows.
struct PoolRowsKernel {
  View<const PooledMoments> moments;
  View<PooledMoments> rows;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const PoolSpan span(x, width);
    PooledMoments sum;
    for (uint32_t i = span.first; i <= span.last; ++i) sum.add(moments[y * width + i]);
    rows[y * width + x] = sum;
  }
};

/// Slope of the sRGB curve at a luminance, 0 above white: the visible change of an image per change of radiance.
RELUME_HD inline float display_slope(float luminance) {
  constexpr float kLinear = 0.0031308f;  // end of the linear segment
  if (luminance > 1.0f) return 0.0f;
  return 1.055f / 2.4f * math::pow(relume::max(luminance, kLinear), 1.0f / 2.4f - 1.0f);
}

/// Standard deviation of one sample at each pixel, from its pool without the pixel: the pixel's values thus do not
/// decide its number of samples.
struct PooledDeviationKernel {
  View<const PooledMoments> moments;
  View<const PooledMoments> rows;
  View<float> deviation;  ///< 0 where no pixel of the pool has two samples
  uint32_t width = 0;
  uint32_t height = 0;
  bool display = false;  ///< measures display values instead of radiance
  float exposure = 1;    ///< exposure factor of the display

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    constexpr float kLargest = 1e18f;
    const PooledMoments sum = pool_without(x, y);
    float result = sum.freedom > 0.0f ? relume::min(std::sqrt(sum.squares / sum.freedom), kLargest) : 0.0f;
    if (display && sum.pixels > 0.0f) result *= exposure * display_slope(exposure * sum.luminance / sum.pixels);
    deviation[y * width + x] = result;
  }

 private:
  RELUME_HD PooledMoments pool_without(uint32_t x, uint32_t y) const {
    PooledMoments sum;
    const PoolSpan columns(x, width);
    for (uint32_t i = columns.first; i <= columns.last; ++i) {
      if (i != x) sum.add(moments[y * width + i]);
    }
    const PoolSpan lines(y, height);
    for (uint32_t i = lines.first; i <= lines.last; ++i) {
      if (i != y) sum.add(rows[i * width + x]);
    }
    return sum;
  }
};

/// Probability of a sample from a deviation, at least `least`: every pixel keeps getting samples.
struct SampleRate {
  float scale = 0;
  float least = 0;

  RELUME_HD float operator()(float deviation) const { return relume::min(relume::max(scale * deviation, least), 1.0f); }
};

/// Sums over pixels, for the choice of a rate.
struct RateSums {
  double deviation = 0;
  double probability = 0;  ///< at a rate
  double cut = 0;          ///< number of pixels whose probability would exceed 1
};

/// The sums of one pixel, as the input of a reduction.
struct PixelRates {
  View<const float> deviation;
  SampleRate rate;

  RELUME_HD RateSums operator()(size_t pixel) const {
    const float d = deviation.data[pixel];
    return {static_cast<double>(d), static_cast<double>(rate(d)), rate.scale * d > 1.0f ? 1.0 : 0.0};
  }
};

struct AddRates {
  using Value = RateSums;
  RELUME_HD static RateSums identity() { return {}; }
  RELUME_HD static RateSums combine(const RateSums& a, const RateSums& b) {
    return {a.deviation + b.deviation, a.probability + b.probability, a.cut + b.cut};
  }
};

/// Decides for each pixel whether it gets a sample in this frame.
struct PooledAllocationKernel {
  View<const float> deviation;
  View<const uint32_t> samples;
  View<float> probability;
  View<uint32_t> allocation;  ///< 0 or 1
  SampleRate rate;
  bool settled = false;  ///< keeps the probabilities: no estimate in this frame, or the pilot has ended
  uint32_t min_samples = 4;
  uint32_t seed = 0;
  uint32_t frame = 0;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (!settled) probability[pixel] = rate(deviation[pixel]);
    allocation[pixel] = samples[pixel] < min_samples || drawn(x, y, probability[pixel]) ? 1u : 0u;
  }

 private:
  /// Draws multiples of the golden ratio, which spread a pixel's samples evenly over frames.
  RELUME_HD bool drawn(uint32_t x, uint32_t y, float share) const {
    constexpr uint32_t kSalt = 0x7ed55d16u;
    constexpr uint32_t kGolden = 0x9e3779b9u;
    return to_unit_float(hash(seed ^ kSalt, x, y) + frame * kGolden) < share;
  }
};

}  // namespace relume
