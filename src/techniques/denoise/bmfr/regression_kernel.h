// The regression over all blocks of an image ([Koskela19] §3.2, 3.3).
#pragma once

#include "frame/launch.h"
#include "techniques/denoise/bmfr/block_regression.h"
#include "techniques/denoise/shared/converge.h"
#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Random numbers per frame that keep a block's features independent: one per pixel and feature, except the constant
/// one.
inline constexpr uint32_t kBlockNoise = (kBlockFeatures - 1) * kBlockPixels;

/// Fills them, uniform in [−1, 1). Grid: kBlockPixels × (kBlockFeatures − 1).
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
  alignas(64) float fit[3][kBlockPixels];
  alignas(64) float weight[kBlockPixels];    ///< root of the sample count; 0: takes no part
  alignas(64) float filtered[kBlockPixels];  ///< 1, or 0: no surface to filter
  alignas(64) float known[kBlockPixels];     ///< 1, or 0: variance unknown
  alignas(64) float variance[kBlockPixels];  ///< variance of the light's luminance if known, else 0
};

/// Edge of the cells in which details are restored, pixels.
inline constexpr uint32_t kDetailCell = 8;

/// Fits the light of one block per call and writes the fit for its pixels. Grid: blocks(width) × blocks(height). The
/// grid of blocks is shifted from frame to frame. Blocks cut off by the border are fitted to a full window of pixels.
struct BlockRegressionKernel {
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const Rgb> albedo;
  View<const Rgb> light;           ///< accumulated light
  View<const uint32_t> samples;    ///< samples in `light`; 0: takes no part
  View<const float> square;        ///< mean square of the samples' luminance
  View<const float> noise;         ///< numbers of BlockNoiseKernel
  View<Rgb> fitted;                ///< fit at filtered pixels
  float share = 1;                 ///< weight of this fit; below 1, an average with the value in `fitted`
  float most_samples = kInfinity;  ///< maximum sample count of light
  float noise_scale = 0;
  float detail = 0;  ///< variances of the noise that the difference of light and fit must exceed; 0: restores nothing
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
    if (detail > 0.0f) restore_details(pixels);
    scatter(written, x0, y0, pixels);
  }

 private:
  static constexpr float kFar = 1e30f;  ///< larger than any position, metres

  RELUME_HD static uint32_t start(uint32_t block, uint32_t shift, uint32_t size) {
    const uint32_t unshifted = block * kBlockSize;
    return unshifted < shift ? 0u : (unshifted - shift < size ? unshifted - shift : size);
  }
  /// First pixel of a block's window.
  RELUME_HD static uint32_t origin(uint32_t first, uint32_t last, uint32_t size) {
    if (first == 0 || size <= kBlockSize) return 0;
    return last == size ? size - kBlockSize : first;
  }

  RELUME_HD float count_at(uint32_t pixel) const {
    return relume::min(static_cast<float>(static_cast<int>(samples[pixel])), most_samples);
  }

  /// Loads the block's pixels. False if none is filtered.
  RELUME_HD bool gather(uint32_t x0, uint32_t y0, BlockPixels& p) const {
    const uint32_t columns = width - x0 < kBlockSize ? width - x0 : kBlockSize;
    const uint32_t rows = height - y0 < kBlockSize ? height - y0 : kBlockSize;
    if (columns < kBlockSize || rows < kBlockSize) p = BlockPixels{};
    for (uint32_t y = 0; y < rows; ++y) gather_row((y0 + y) * width + x0, y * kBlockSize, columns, p);
    Vec3 low;
    Vec3 high;
    for (int c = 0; c < 3; ++c) range_of(p, c, low[c], high[c]);
    if (!(low.x <= high.x)) return false;
    normalise(low, high, p);
    return true;
  }

  /// Loads `count` pixels of the image from `pixel` on into the block, from `first` on.
  RELUME_HD void gather_row(uint32_t pixel, uint32_t first, uint32_t count, BlockPixels& p) const {
    uint32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      float numbers[kLanes];
      for (uint32_t k = 0; k < kLanes; ++k) numbers[k] = count_at(pixel + i + k);
      const PixelLanes lanes(&position[pixel + i].x, &normal[pixel + i].x, &albedo[pixel + i].r, &light[pixel + i].r,
                             numbers, &square[pixel + i]);
      lanes.put(first + i, p);
    }
    if (i == count) return;
    // Remainder of images smaller than a block.
    float values[4][3 * kLanes] = {};
    float numbers[kLanes] = {};
    float squares[kLanes] = {};
    for (uint32_t k = 0; i + k < count; ++k) {
      const uint32_t from = pixel + i + k;
      for (uint32_t c = 0; c < 3; ++c) {
        const auto component = static_cast<int>(c);
        values[0][3 * k + c] = position[from][component];
        values[1][3 * k + c] = normal[from][component];
        values[2][3 * k + c] = albedo[from][component];
        values[3][3 * k + c] = light[from][component];
      }
      numbers[k] = count_at(from);
      squares[k] = square[from];
    }
    PixelLanes(values[0], values[1], values[2], values[3], numbers, squares).put(first + i, p);
  }

  /// kLanes pixels in a row.
  struct PixelLanes {
    Lanes position[3];
    Lanes normal[3];
    Lanes light[3];
    Lanes filtered;
    Lanes count;
    Lanes square;

    RELUME_HD_INLINE PixelLanes(const float* positions, const float* normals, const float* albedos, const float* lights,
                                const float* counts, const float* squares)
        : count(load_lanes(counts)), square(load_lanes(squares)) {
      Lanes reflected[3];
      load_vectors(positions, position);
      load_vectors(normals, normal);
      load_vectors(albedos, reflected);
      load_vectors(lights, light);
      const Lanes zero(0.0f);
      filtered = select(max(max(reflected[0], reflected[1]), reflected[2]) < kLeastAlbedo, zero, 1.0f);
      count = count * filtered;
      for (int c = 0; c < 3; ++c) {
        position[c] = position[c] * filtered;
        normal[c] = normal[c] * filtered;
        light[c] = select(zero < count, light[c], zero);
      }
    }

    RELUME_HD_INLINE void put(uint32_t i, BlockPixels& p) const {
      const Lanes zero(0.0f);
      const Lanes one(1.0f);
      for (int c = 0; c < 3; ++c) {
        store_lanes(p.position[c] + i, position[c]);
        store_lanes(p.normal[c] + i, normal[c]);
        store_lanes(p.light[c] + i, light[c]);
      }
      const Lanes known = select(count < Lanes(static_cast<float>(kKnownSamples)), zero, one);
      const Lanes y = luminance(light[0], light[1], light[2]);
      store_lanes(p.filtered + i, filtered);
      store_lanes(p.weight + i, square_root(count));
      store_lanes(p.known + i, known);
      store_lanes(p.variance + i, known * max(square - y * y, zero) / max(count - one, one));
    }
  };

  /// Range of a position's component over filtered pixels; low above high without any.
  RELUME_HD static void range_of(const BlockPixels& p, int c, float& low, float& high) {
    const Lanes one(1.0f);
    const Lanes far(kFar);
    Lanes highest(-kFar);
    Lanes lowest_negated = highest;
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes) {
      const Lanes x = load_lanes(p.position[c] + i);
      const Lanes away = (one - load_lanes(p.filtered + i)) * far;
      highest = max(highest, x - away);
      lowest_negated = max(lowest_negated, 0.0f - x - away);
    }
    low = kFar;
    high = -kFar;
    for (uint32_t i = 0; i < kLanes; ++i) {
      low = relume::min(low, -lowest_negated[i]);
      high = relume::max(high, highest[i]);
    }
  }

  /// Scales positions to [−1, 1].
  RELUME_HD static void normalise(const Vec3& low, const Vec3& high, BlockPixels& p) {
    for (int c = 0; c < 3; ++c) {
      const float extent = high[c] - low[c];
      const Lanes middle(0.5f * (low[c] + high[c]));
      const Lanes scale(extent > 0.0f ? 2.0f / extent : 0.0f);
      for (uint32_t i = 0; i < kBlockPixels; i += kLanes)
        store_lanes(p.position[c] + i, (load_lanes(p.position[c] + i) - middle) * scale);
    }
  }

  /// Feature f of kLanes pixels.
  RELUME_HD_INLINE static Lanes feature(const BlockPixels& p, int f, uint32_t i) {
    if (f == 0) return Lanes(1.0f);
    if (f < 4) return load_lanes(p.normal[f - 1] + i);
    const Lanes x = load_lanes(p.position[(f - 4) % 3] + i);
    return f < 7 ? x : x * x;
  }

  RELUME_HD BlockFit solve(const BlockPixels& p) const {
    BlockRegression regression;
    regression.begin();
    const Lanes scale(noise_scale);
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

  RELUME_HD static void evaluate(const BlockFit& fit, BlockPixels& p) {
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes) {
      Lanes sums[3] = {Lanes(0.0f), Lanes(0.0f), Lanes(0.0f)};
      for (int f = 0; f < kBlockFeatures; ++f) {
        const Lanes value = feature(p, f, i);
        for (int c = 0; c < 3; ++c) sums[c] = sums[c] + value * fit.coefficients[c][f];
      }
      for (int c = 0; c < 3; ++c) store_lanes(p.fit[c] + i, sums[c]);
    }
  }

  /// Puts back the share of the difference of light and fit that noise does not explain, cell by cell (Wiener's
  /// filter). This keeps light that features cannot express: caustics, shadows, reflections.
  RELUME_HD void restore_details(BlockPixels& p) const {
    for (uint32_t top = 0; top < kBlockSize; top += kDetailCell) {
      for (uint32_t left = 0; left < kBlockSize; left += kDetailCell) restore_cell(top * kBlockSize + left, p);
    }
  }

  /// Restores the cell whose first pixel is `first`.
  RELUME_HD void restore_cell(uint32_t first, BlockPixels& p) const {
    static_assert(kDetailCell == kLanes);
    constexpr uint32_t kEnd = kDetailCell * kBlockSize;
    Lanes differences(0.0f);
    Lanes variances(0.0f);
    for (uint32_t i = first; i < first + kEnd; i += kBlockSize) {
      Lanes left_over[3];
      for (int c = 0; c < 3; ++c) left_over[c] = load_lanes(p.light[c] + i) - load_lanes(p.fit[c] + i);
      const Lanes y = luminance(left_over[0], left_over[1], left_over[2]) * load_lanes(p.known + i);
      differences = differences + y * y;
      variances = variances + load_lanes(p.variance + i);
    }
    const float all = sum_of(differences);
    const float kept = all > 0.0f ? 1.0f - detail * sum_of(variances) / all : 0.0f;
    if (!(kept > 0.0f)) return;
    for (uint32_t i = first; i < first + kEnd; i += kBlockSize) {
      const Lanes share_kept = kept * load_lanes(p.known + i);
      for (int c = 0; c < 3; ++c) {
        const Lanes fit = load_lanes(p.fit[c] + i);
        store_lanes(p.fit[c] + i, fit + (load_lanes(p.light[c] + i) - fit) * share_kept);
      }
    }
  }

  RELUME_HD void scatter(const Tile& written, uint32_t x0, uint32_t y0, const BlockPixels& p) const {
    for (uint32_t y = written.y0; y < written.y1; ++y) {
      for (uint32_t x = written.x0; x < written.x1; ++x) {
        const uint32_t i = (y - y0) * kBlockSize + x - x0;
        const Rgb fit = glm::max(Rgb(p.fit[0][i], p.fit[1][i], p.fit[2][i]), Rgb(0));
        Rgb& average = fitted[y * width + x];
        average = share < 1.0f ? average + (fit - average) * share : fit;
      }
    }
  }
};

}  // namespace relume
