// Finds changes of light since the histories of denoisers were accumulated. After a lamp or an object has moved, a
// frame's samples differ from the history. One sample is too noisy to show it; those of a block and the blocks around
// it suffice.
#pragma once

#include "frame/launch.h"
#include "sampling/chi2_bound.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {

/// Compares the samples of each block with its history. Grid: change_blocks(width) × change_blocks(height).
struct CompareBlocksKernel {
  LightHistory history;
  /// (Σ d)² / Σ d² over the block's pixels, d: luminance of the sample minus that of the history. It is divided by its
  /// expectation without a change, which is above 1 where pixels share parts of the history. Its mean is thus about 1
  /// while nothing changes, for any noise. Below 0: unknown.
  View<float> departures;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t block_x, uint32_t block_y) const {
    float sum = 0;
    float squares = 0;
    // Sums over pixels of their contributions to (Σ d)² and to Σ d² without a change, in variances of a sample.
    float variance_of_sum = 0;
    float sum_of_variances = 0;
    uint32_t compared = 0;
    for (uint32_t y = block_y * kChangeBlock; y < (block_y + 1) * kChangeBlock && y < height; ++y) {
      for (uint32_t x = block_x * kChangeBlock; x < (block_x + 1) * kChangeBlock && x < width; ++x) {
        const SurfaceLightSample sample = history.samples.at(y * width + x);
        if (!sample.valid) continue;
        const BackwardTaps taps = history.reprojection.taps(x, y).known(history.count_before);
        const uint32_t age = taps.least(history.count_before);
        if (age == 0) continue;
        const float d = luminance(sample.light) - luminance(taps.fetch(history.light_before));
        sum += d;
        squares += sqr(d);
        const float past = 1.0f / static_cast<float>(age);
        variance_of_sum += 1.0f + past;
        sum_of_variances += 1.0f + past * taps.variance_share();
        ++compared;
      }
    }
    constexpr uint32_t kFewest = 8;  // minimum for a meaningful quotient
    departures[block_y * change_blocks(width) + block_x] =
        compared >= kFewest && squares > 0.0f ? sqr(sum) / squares * (sum_of_variances / variance_of_sum) : -1.0f;
  }
};

/// Discounts the history of each block. Departures estimate its squared bias b². If a filter averages the block's n
/// samples of variance v, the error is least when the history counts for v / (n b²) samples. In terms of the block's
/// departure, that is 1 / (departure − 1).
struct DiscountBlocksKernel {
  View<const float> departures;
  View<float> discounts;  ///< LightHistory::discounts
  uint32_t columns = 0;
  uint32_t rows = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    float sum = 0;
    float count = 0;
    for (uint32_t v = y > 0 ? y - 1 : 0; v <= y + 1 && v < rows; ++v) {
      for (uint32_t u = x > 0 ? x - 1 : 0; u <= x + 1 && u < columns; ++u) {
        const float departure = departures[v * columns + u];
        if (departure < 0.0f) continue;
        sum += departure;
        count += 1.0f;
      }
    }
    const float excess = count > 0.0f ? sum / count - 1.0f : 0.0f;
    constexpr float kStandardErrors = 1.5f;
    const float chance = chi2_mean_bound(relume::max(count, 1.0f), kStandardErrors);
    discounts[y * columns + x] = excess > chance ? excess : 0.0f;
  }
};

}  // namespace relume
