// The regression over all blocks of a picture ([Koskela19] §3.2, 3.3).
#pragma once

#include "backend/launch.h"
#include "techniques/bmfr/block_regression.h"
#include "techniques/features/features.h"

namespace relume {

/// Random numbers of a frame that keep a block's features independent: one a feature (but the constant one) and pixel.
inline constexpr uint32_t kBlockNoise = (kBlockFeatures - 1) * kBlockPixels;

/// Fills them, uniform in [−1, 1). A grid of kBlockPixels × (kBlockFeatures − 1).
struct BlockNoiseKernel {
  View<float> noise;
  uint32_t frame = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    noise[y * kBlockPixels + x] = 2.0f * to_unit_float(hash(x, y, frame)) - 1.0f;
  }
};

/// A block's pixels, by columns.
struct BlockPixels {
  alignas(64) float normal[3][kBlockPixels];
  alignas(64) float position[3][kBlockPixels];
  alignas(64) float light[3][kBlockPixels];
  alignas(64) float weight[kBlockPixels];  ///< 0: takes no part
  float variance[kBlockPixels];            ///< of the luminance of the light; negative: not known
};

/// What a fit leaves of the light is looked at in cells of this edge, pixels.
inline constexpr uint32_t kCellSize = 8;
/// Samples from which the variance of their mean counts as known.
inline constexpr uint32_t kKnownSamples = 4;

/// Fits the light of one block a call and writes the fit for its pixels: a grid of block_grid(). Blocks lie on a grid
/// that is shifted from frame to frame; what it cuts off at the border is fitted with as many pixels as any other
/// block.
struct BlockRegressionKernel {
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const Rgb> albedo;
  View<const Rgb> light;         ///< accumulated
  View<const uint32_t> samples;  ///< that are in it; 0: takes no part
  View<const float> square;      ///< mean square of their luminance
  View<const float> noise;       ///< BlockNoiseKernel's
  View<Rgb> fitted;              ///< of pixels that are filtered
  float share = 1;               ///< of this fit in it; below 1 it is averaged with what is there
  float noise_scale = 0;
  float detail = 0;      ///< variances by which the light must differ from the fit to be kept; 0: never
  uint32_t shift_x = 0;  ///< in [0, kBlockSize)
  uint32_t shift_y = 0;
  uint32_t width = 0;
  uint32_t height = 0;

  /// Blocks along an edge of `size` pixels.
  RELUME_HD static constexpr uint32_t blocks(uint32_t size) { return size / kBlockSize + 2; }

  RELUME_HD void operator()(uint32_t block_x, uint32_t block_y) const {
    const Tile written = {start(block_x, shift_x, width), start(block_y, shift_y, height),
                          start(block_x + 1, shift_x, width), start(block_y + 1, shift_y, height)};
    if (written.x0 == written.x1 || written.y0 == written.y1) return;
    const uint32_t x0 = origin(written.x0, written.x1, width);
    const uint32_t y0 = origin(written.y0, written.y1, height);
    BlockPixels pixels;
    if (!gather(x0, y0, pixels)) return;
    const BlockFit fit = solve(pixels);
    evaluate(fit, pixels);
    if (detail > 0.0f) restore_details(x0, y0, pixels);
    scatter(written, x0, y0, pixels);
  }

 private:
  RELUME_HD static uint32_t start(uint32_t block, uint32_t shift, uint32_t size) {
    const uint32_t unshifted = block * kBlockSize;
    return unshifted < shift ? 0u : (unshifted - shift < size ? unshifted - shift : size);
  }
  /// First pixel of the window that a block is fitted in.
  RELUME_HD static uint32_t origin(uint32_t first, uint32_t last, uint32_t size) {
    if (first == 0 || size <= kBlockSize) return 0;
    return last == size ? size - kBlockSize : first;
  }

  /// False if no pixel is to be fitted.
  RELUME_HD bool gather(uint32_t x0, uint32_t y0, BlockPixels& p) const {
    Vec3 low(kInfinity);
    Vec3 high(-kInfinity);
    for (uint32_t i = 0; i < kBlockPixels; ++i) {
      const uint32_t x = x0 + i % kBlockSize;
      const uint32_t y = y0 + i / kBlockSize;
      const uint32_t pixel = y * width + x;
      const bool inside = x < width && y < height && is_filtered(albedo[pixel]);
      const Vec3 where = inside ? position[pixel] : Vec3(0);
      const Vec3 n = inside ? normal[pixel] : Vec3(0);
      const uint32_t count = inside ? samples[pixel] : 0;
      const Rgb value = count > 0 ? light[pixel] : Rgb(0);
      for (int c = 0; c < 3; ++c) {
        p.position[c][i] = where[c];
        p.normal[c][i] = n[c];
        p.light[c][i] = value[c];
      }
      p.weight[i] = count > 0 ? std::sqrt(static_cast<float>(count)) : 0.0f;
      p.variance[i] = count < kKnownSamples
                          ? -1.0f
                          : relume::max(square[pixel] - sqr(luminance(value)), 0.0f) / static_cast<float>(count - 1);
      if (!inside) continue;
      low = glm::min(low, where);
      high = glm::max(high, where);
    }
    if (!(low.x <= high.x)) return false;
    normalise(low, high, p);
    return true;
  }

  /// Positions to [−1, 1].
  RELUME_HD static void normalise(const Vec3& low, const Vec3& high, BlockPixels& p) {
    for (int c = 0; c < 3; ++c) {
      const float extent = high[c] - low[c];
      const Lanes middle = lanes_of(0.5f * (low[c] + high[c]));
      const Lanes scale = lanes_of(extent > 0.0f ? 2.0f / extent : 0.0f);
      for (uint32_t i = 0; i < kBlockPixels; i += kLanes)
        store_lanes(p.position[c] + i, (load_lanes(p.position[c] + i) - middle) * scale);
    }
  }

  /// A feature of kLanes pixels.
  RELUME_HD_INLINE static Lanes feature(const BlockPixels& p, int f, uint32_t i) {
    if (f == 0) return lanes_of(1.0f);
    if (f < 4) return load_lanes(p.normal[f - 1] + i);
    const Lanes x = load_lanes(p.position[(f - 4) % 3] + i);
    return f < 7 ? x : x * x;
  }

  RELUME_HD BlockFit solve(const BlockPixels& p) const {
    BlockRegression regression;
    regression.begin();
    const Lanes scale = lanes_of(noise_scale);
    for (uint32_t first = 0; first < kBlockPixels; first += BlockRegression::kPanelRows) {
      for (int f = 0; f < kBlockColumns; ++f) {
        float* column = regression.columns[f] + BlockRegression::kTriangle;
        for (uint32_t i = first; i < first + BlockRegression::kPanelRows; i += kLanes, column += kLanes) {
          Lanes value = f < kBlockFeatures ? feature(p, f, i) : load_lanes(p.light[f - kBlockFeatures] + i);
          if (f > 0 && f < kBlockFeatures)
            value = value + scale * load_lanes(noise.data + static_cast<uint32_t>(f - 1) * kBlockPixels + i);
          store_lanes(column, value * load_lanes(p.weight + i));
        }
      }
      regression.add_panel();
    }
    return regression.fit();
  }

  /// Puts the fit in the place of the light.
  RELUME_HD static void evaluate(const BlockFit& fit, BlockPixels& p) {
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes) {
      Lanes sums[3] = {lanes_of(0.0f), lanes_of(0.0f), lanes_of(0.0f)};
      for (int f = 0; f < kBlockFeatures; ++f) {
        const Lanes value = feature(p, f, i);
        for (int c = 0; c < 3; ++c) sums[c] = sums[c] + value * lanes_of(fit.coefficients[c][f]);
      }
      for (int c = 0; c < 3; ++c) store_lanes(p.light[c] + i, sums[c]);
    }
  }

  /// Cell by cell: as far as the light differs from the fit by more than its noise explains, the difference is no
  /// noise, and is put back (Wiener's filter). What features cannot tell survives in this way: caustics, shadows,
  /// reflections.
  RELUME_HD void restore_details(uint32_t x0, uint32_t y0, BlockPixels& p) const {
    for (uint32_t cell = 0; cell < kBlockPixels / (kCellSize * kCellSize); ++cell) {
      const uint32_t left = cell % (kBlockSize / kCellSize) * kCellSize;
      const uint32_t top = cell / (kBlockSize / kCellSize) * kCellSize;
      float differences = 0;
      float variances = 0;
      for (uint32_t k = 0; k < kCellSize * kCellSize; ++k) {
        const uint32_t i = (top + k / kCellSize) * kBlockSize + left + k % kCellSize;
        if (p.variance[i] < 0.0f) continue;
        differences += sqr(luminance(left_over(x0, y0, i, p)));
        variances += p.variance[i];
      }
      const float kept = differences > 0.0f ? 1.0f - detail * variances / differences : 0.0f;
      if (!(kept > 0.0f)) continue;
      for (uint32_t k = 0; k < kCellSize * kCellSize; ++k) {
        const uint32_t i = (top + k / kCellSize) * kBlockSize + left + k % kCellSize;
        if (p.variance[i] < 0.0f) continue;
        const Rgb difference = left_over(x0, y0, i, p) * kept;
        for (int c = 0; c < 3; ++c) p.light[c][i] += difference[c];
      }
    }
  }

  /// Light that the fit, by now in the light's place, does not explain.
  RELUME_HD Rgb left_over(uint32_t x0, uint32_t y0, uint32_t i, const BlockPixels& p) const {
    const uint32_t pixel = (y0 + i / kBlockSize) * width + x0 + i % kBlockSize;
    return light[pixel] - Rgb(p.light[0][i], p.light[1][i], p.light[2][i]);
  }

  RELUME_HD void scatter(const Tile& written, uint32_t x0, uint32_t y0, const BlockPixels& p) const {
    for (uint32_t y = written.y0; y < written.y1; ++y) {
      for (uint32_t x = written.x0; x < written.x1; ++x) {
        const uint32_t i = (y - y0) * kBlockSize + x - x0;
        const Rgb fit = glm::max(Rgb(p.light[0][i], p.light[1][i], p.light[2][i]), Rgb(0));
        Rgb& average = fitted[y * width + x];
        average = share < 1.0f ? average + (fit - average) * share : fit;
      }
    }
  }
};

}  // namespace relume
