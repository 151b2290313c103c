// Contents of a cell of the hash grid: integer sums of this frame's samples and float moments of earlier frames. The
// sums do not depend on the order of additions; a single writer updates the moments between frames.
#pragma once

#include "core/fixed_point.h"

namespace relume {

/// Largest component of a sample; larger ones are clamped and counted as saturated.
inline constexpr float kCellSampleMax = 0x1p24f;
/// Unit of a sample's weight, and the largest weight. Samples must have a probability of at least 1 / kCellWeightMax.
inline constexpr float kCellWeightUnit = 0x1p-8f;
inline constexpr float kCellWeightMax = 0x1p12f;

/// Non-negative number of 128 bits: high · 2^64 + low.
struct WideInteger {
  uint64_t low = 0;
  uint64_t high = 0;
};

/// `x` ≥ 0 in units of 2^-fraction_bits, rounded down. Intermediate results are exact. x · 2^fraction_bits must be
/// below 2^128.
template <int fraction_bits>
RELUME_HD inline WideInteger to_wide(double x) {
  static_assert(fraction_bits < 64);
  constexpr double kLowUnits = static_cast<double>(uint64_t{1} << fraction_bits);
  const double in_high = x * (kLowUnits * 0x1p-64);
  // Via a signed integer, for which processors have an instruction.
  if (in_high < 0x1p-1) return {static_cast<uint64_t>(static_cast<int64_t>(x * kLowUnits)), 0};
  const auto high = static_cast<uint64_t>(in_high);
  return {static_cast<uint64_t>((in_high - static_cast<double>(high)) * 0x1p64), high};
}

template <int fraction_bits>
RELUME_HD inline double from_wide(uint64_t low, uint64_t high) {
  constexpr double kUnit = 1.0 / static_cast<double>(uint64_t{1} << fraction_bits);
  return (static_cast<double>(high) * 0x1p64 + static_cast<double>(low)) * kUnit;
}

/// Moments of the samples in a cell.
struct CellMoments {
  Rgb mean{0};
  float mean_square = 0;  ///< mean square of the luminance
  float count = 0;        ///< number of samples, bounded by the maximum cell size

  /// Variance of the luminance of one sample, unbiased for samples of equal weight ([Schipek22 eq. 3.2]).
  RELUME_HD float variance() const {
    if (!(count > 1.0f)) return 0.0f;
    return relume::max(0.0f, mean_square - sqr(luminance(mean))) * (count / (count - 1.0f));
  }
};

/// Sums of this frame's samples. The squares of sunlight and dusk differ by more than 64 bits, so sums have two limbs.
/// Carries into the upper limb are rare, and only they access it.
struct alignas(64) CellSums {
  static constexpr int kRadianceBits = 40;  ///< fractional bits of the sums of radiance
  static constexpr int kSquareBits = 56;    ///< fractional bits of the sum of squares

  uint64_t low[3] = {};
  uint64_t square_low = 0;
  uint64_t square_high = 0;
  uint64_t weight = 0;  ///< sum of weights in units of kCellWeightUnit
  uint32_t high[3] = {};
  uint32_t count = 0;

  RELUME_HD bool empty() const { return count == 0; }

  /// Thread-safe. `value`: finite components in [0, kCellSampleMax]; `weight` in (0, kCellWeightMax]. Returns whether
  /// this is the first sample of the frame.
  RELUME_HD bool add(const Rgb& value, float sample_weight) {
    const auto units = static_cast<uint64_t>(sample_weight / kCellWeightUnit + 0.5f);
    const double w = static_cast<double>(units) * static_cast<double>(kCellWeightUnit);
    for (int c = 0; c < 3; ++c) {
      const WideInteger x = to_wide<kRadianceBits>(static_cast<double>(value[c]) * w);
      const uint64_t carry = add_low(&low[c], x.low);
      if (x.high + carry != 0) atomic_add(&high[c], static_cast<uint32_t>(x.high + carry));
    }
    const auto y = static_cast<double>(luminance(value));
    const WideInteger square = to_wide<kSquareBits>(y * y * w);
    const uint64_t carry = add_low(&square_low, square.low);
    if (square.high + carry != 0) atomic_add(&square_high, square.high + carry);
    atomic_add(&weight, units);
    return atomic_fetch_add(&count, 1u) == 0;
  }

  RELUME_HD CellMoments moments() const {
    if (empty() || weight == 0) return {};
    const double scale = 1.0 / (static_cast<double>(weight) * static_cast<double>(kCellWeightUnit));
    CellMoments m;
    for (int c = 0; c < 3; ++c) m.mean[c] = static_cast<float>(from_wide<kRadianceBits>(low[c], high[c]) * scale);
    m.mean_square = static_cast<float>(from_wide<kSquareBits>(square_low, square_high) * scale);
    m.count = static_cast<float>(count);
    return m;
  }

 private:
  /// Returns the carry.
  RELUME_HD static uint64_t add_low(uint64_t* target, uint64_t value) {
    if (value == 0) return 0;
    const uint64_t before = atomic_fetch_add(target, value);
    return before + value < before ? 1u : 0u;
  }
};
static_assert(sizeof(CellSums) == 64);

/// Moments of earlier frames.
struct CellHistory {
  CellMoments moments;
  CellMoments recent;     ///< window of the latest frames, still too small for a comparison
  uint32_t age = 0;       ///< frames since the last sample
  int16_t departure = 0;  ///< windows in a row above (positive) or below the history's confidence interval
  uint16_t changed = 0;   ///< 1 if the latest window departed from the history, alone or with its region
  uint32_t frames = 0;    ///< frames with samples since the cell started; with max_frames, all, up to 2 max_frames

  RELUME_HD bool empty() const { return moments.count <= 0.0f; }
};
static_assert(sizeof(CellHistory) == 52);

/// Parameters of pooling a frame with a history.
struct AveragingRule {
  float max_count = 1024;      ///< maximum cell size N ([Schipek22 §5.3]); beyond it the average is exponential
  float change_threshold = 0;  ///< allowed deviation of a window's mean in standard errors; 0: no limit
  float min_count = 8;         ///< samples below which a cell is undersampled and cells and windows are not compared
  uint32_t max_frames = 0;     ///< frames that the average of an old cell is worth, whatever their samples; 0: no limit
};

/// Treatment of undersampled cells, which have fewer samples than `min_count`.
enum class UndersampledCells : int {
  keep,               ///< the cell alone
  coarser,            ///< pooled with cells of up to three coarser levels
  neighbours,         ///< pooled with the eight nearest cells
  neighbours_coarser  ///< the same, then with coarser cells that distinguish half as many normals
};

/// Windows in a row that must deviate to one side before a history is discarded. A single one may be an outlier.
inline constexpr int kDeparturesOfAChange = 2;

/// Deviation of a window's mean luminance from the history's, and its expected size without a change.
struct Departure {
  float difference = 0;
  float noise_squared = 0;     ///< variance of the difference
  float rounding_squared = 0;  ///< squared rounding error of the means
};

RELUME_HD inline Departure departure_of(const CellMoments& history, const CellMoments& window) {
  constexpr float kRoundingError = 1e-4f;
  const float before = luminance(history.mean);
  // Where bright samples are rare, either variance may be underestimated.
  const float variance = relume::max(history.variance(), window.variance());
  return {luminance(window.mean) - before, variance * (1.0f / history.count + 1.0f / window.count),
          sqr(kRoundingError * before)};
}

/// −1 or 1 if the luminance of the window's mean is below or above the confidence interval of the history, else 0.
RELUME_HD inline int departure(const CellMoments& history, const CellMoments& window, const AveragingRule& rule) {
  if (history.count < rule.min_count) return 0;
  const Departure d = departure_of(history, window);
  if (sqr(d.difference) <= sqr(rule.change_threshold) * d.noise_squared + d.rounding_squared) return 0;
  return d.difference < 0.0f ? -1 : 1;
}

/// Exponential average by batches ([Schipek22 §5.3]): pools the samples of both, then limits their number to N.
RELUME_HD inline CellMoments pooled(const CellMoments& history, const CellMoments& frame, float max_count) {
  const float count = history.count + frame.count;
  if (!(count > 0.0f)) return {};
  const float share = frame.count / count;
  CellMoments m;
  m.mean = history.mean + (frame.mean - history.mean) * share;
  m.mean_square = history.mean_square + (frame.mean_square - history.mean_square) * share;
  m.count = relume::min(count, max_count);
  return m;
}

}  // namespace relume
