// Converges denoised images to the mean of all samples.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"
#include "core/view.h"
#include "frame/launch.h"

namespace relume {

/// Least number of samples with a known variance of their mean.
inline constexpr uint32_t kKnownSamples = 4;

/// Blends the image to the mean of all samples once the mean's error is below the filter's bias. The share is the part
/// of their squared difference, around the pixel, that the noise of the mean does not explain.
struct ConvergeKernel {
  View<const Rgb> image;
  View<const Rgb> mean;
  View<const float> m2;  ///< sum of squared distances of the samples' luminance from its mean
  View<const uint32_t> samples;
  View<Rgb> converged;
  bool stratified = false;  ///< as in FrameContext
  bool still = false;       ///< nothing has changed; otherwise the mean is not trusted
  uint32_t width = 0;
  uint32_t height = 0;
  float correlated_frames = 1;  ///< as in FrameContext

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Difference sum;
    for (uint32_t v = y > kReach ? y - kReach : 0; still && v <= y + kReach && v < height; ++v) {
      Difference row;
      for (uint32_t u = x > kReach ? x - kReach : 0; u <= x + kReach && u < width; ++u) row += at(v * width + u);
      sum += row;
    }
    finish(y * width + x, sum);
  }

  /// Host: reads each pixel once and sums rows of the tile, which vectorises.
  void operator()(const Tile& tile) const {
    SumsOfRow sums[kTileSize] = {};
    for (uint32_t j = 0; still && j < kEdge; ++j) {
      const uint32_t y = tile.y0 + j - kReach;  // wraps beyond the height above the image
      if (y >= height) continue;
      const SumsOfRow row = row_around(tile.x0, y);
      for (uint32_t t = j > 2 * kReach ? j - 2 * kReach : 0; t <= j && t < kTileSize; ++t)
        sums[t].add(row.squared, row.variance, row.most_squared, row.most_variance);
    }
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      const SumsOfRow& row = sums[y - tile.y0];
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        const uint32_t i = x - tile.x0;
        finish(y * width + x, {row.squared[i], row.variance[i], row.most_squared[i], row.most_variance[i]});
      }
    }
  }

 private:
  static constexpr uint32_t kReach = 2;
  static constexpr uint32_t kEdge = kTileSize + 2 * kReach;
  static constexpr uint32_t kPaddedEdge = (kEdge + kLanes - 1) / kLanes * kLanes;
  static constexpr float kStratifiedSamples = 16;  ///< sample count above which stratification is assumed

  /// Sums over pixels. The largest difference is kept apart: it may be a firefly.
  struct Difference {
    float squared = 0;
    float variance = 0;
    float most_squared = 0;
    float most_variance = 0;  ///< assumed reduction of that pixel's variance by stratification

    RELUME_HD void operator+=(const Difference& other) {
      squared += other.squared;
      variance += other.variance;
      if (other.most_squared <= most_squared) return;
      most_squared = other.most_squared;
      most_variance = other.most_variance;
    }
  };

  /// A Difference for each pixel in a row of a tile.
  struct SumsOfRow {
    float squared[kTileSize];
    float variance[kTileSize];
    float most_squared[kTileSize];
    float most_variance[kTileSize];

    RELUME_HD_INLINE void add(const float* squares, const float* variances, const float* most_squares,
                              const float* most_variances) {
      for (uint32_t i = 0; i < kTileSize; i += kLanes) {
        store_lanes(squared + i, load_lanes(squared + i) + load_lanes(squares + i));
        store_lanes(variance + i, load_lanes(variance + i) + load_lanes(variances + i));
        const Lanes most = load_lanes(most_squared + i);
        const Lanes other = load_lanes(most_squares + i);
        store_lanes(most_variance + i,
                    select(most < other, load_lanes(most_variances + i), load_lanes(most_variance + i)));
        store_lanes(most_squared + i, select(most < other, other, most));
      }
    }
  };

  /// Differences of kTileSize pixels from (x0, y) on, each summed over its neighbours in the row.
  SumsOfRow row_around(uint32_t x0, uint32_t y) const {
    float squares[kPaddedEdge] = {};
    float variances[kPaddedEdge] = {};
    float most_variances[kPaddedEdge] = {};
    const bool inside_image = x0 >= kReach && x0 - kReach + kPaddedEdge <= width;
    for (uint32_t i = 0; inside_image && i < kPaddedEdge; i += kLanes)
      at(y * width + x0 + i - kReach, squares + i, variances + i, most_variances + i);
    for (uint32_t i = inside_image ? kEdge : x0 < kReach ? kReach - x0 : 0; i < kEdge && x0 + i - kReach < width; ++i) {
      const Difference d = at(y * width + x0 + i - kReach);
      squares[i] = d.squared;
      variances[i] = d.variance;
      most_variances[i] = d.most_variance;
    }
    SumsOfRow row = {};
    for (uint32_t k = 0; k <= 2 * kReach; ++k) row.add(squares + k, variances + k, squares + k, most_variances + k);
    return row;
  }

  /// The variance of a mean of stratified samples falls about as n^(−3/2), not as n⁻¹, which the estimate assumes. Few
  /// samples are not assumed to be stratified: light found by one of eight is not.
  RELUME_HD Difference at(uint32_t pixel) const {
    if (samples[pixel] < kKnownSamples) return {};
    const auto n = static_cast<float>(static_cast<int>(samples[pixel]));
    const float gain = stratified && n > kStratifiedSamples ? std::sqrt(kStratifiedSamples / n) : 1.0f;
    const float squared = sqr(luminance(mean[pixel] - image[pixel]));
    const float variance = m2[pixel] / (n * (n - 1.0f)) * relume::min(n, correlated_frames);
    return {squared, gain * variance, squared, (1.0f - gain) * variance};
  }

  /// The same for kLanes pixels from `pixel` on.
  void at(uint32_t pixel, float* squares, float* variances, float* most_variances) const {
    float counts[kLanes];
    for (uint32_t k = 0; k < kLanes; ++k) counts[k] = static_cast<float>(static_cast<int>(samples[pixel + k]));
    const Lanes least(static_cast<float>(kKnownSamples));
    const Lanes one(1.0f);
    const Lanes known = select(load_lanes(counts) < least, Lanes(0.0f), one);
    const Lanes n = max(load_lanes(counts), least);
    const Lanes many(kStratifiedSamples);
    const Lanes gain = stratified ? square_root(many / max(n, many)) : one;
    Lanes of_mean[3];
    Lanes of_image[3];
    load_vectors(&mean[pixel].r, of_mean);
    load_vectors(&image[pixel].r, of_image);
    const Lanes difference = luminance(of_mean[0] - of_image[0], of_mean[1] - of_image[1], of_mean[2] - of_image[2]);
    const Lanes variance = known * (load_lanes(&m2[pixel]) / (n * (n - one)) * min(n, Lanes(correlated_frames)));
    store_lanes(squares, known * (difference * difference));
    store_lanes(variances, gain * variance);
    store_lanes(most_variances, (one - gain) * variance);
  }

  RELUME_HD void finish(uint32_t pixel, const Difference& around) const {
    const float variance = around.variance + around.most_variance;
    float share = around.squared > 0.0f ? 1.0f - variance / around.squared : 0.0f;
    if (!(share > 0.0f) || samples[pixel] < kKnownSamples) share = 0.0f;
    // Samples that miss some of the shown emission may leave a mean slightly below black at edges.
    converged[pixel] = glm::max(image[pixel] + (mean[pixel] - image[pixel]) * share, Rgb(0));
  }
};

}  // namespace relume
