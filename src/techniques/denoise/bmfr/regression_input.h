// Input of the block regression: buffers of the image, and pixels as rows of the system of equations.
#pragma once

#include "frame/launch.h"
#include "techniques/denoise/bmfr/block_regression.h"
#include "techniques/denoise/shared/converge.h"
#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Random numbers per frame that keep a block's features independent: one per pixel and feature, except the constant
/// one.
inline constexpr uint32_t kBlockNoise = (kBlockFeatures - 1) * kBlockPixels;

/// Edge of the cells in which details are restored, pixels.
inline constexpr uint32_t kDetailCell = 8;
/// Cells along an edge of a block.
inline constexpr uint32_t kDetailCells = kBlockSize / kDetailCell;

/// The pixels of a block.
struct BlockWindow {
  Tile written;     ///< pixels that receive the fit
  uint32_t x0 = 0;  ///< first pixel of the window that is fitted, of kBlockSize × kBlockSize pixels
  uint32_t y0 = 0;
  uint32_t columns = 0;  ///< pixels of the window inside the image
  uint32_t rows = 0;

  RELUME_HD bool empty() const { return written.x0 == written.x1 || written.y0 == written.y1; }
  /// Index in the window of a pixel of the image.
  RELUME_HD uint32_t index(uint32_t x, uint32_t y) const { return (y - y0) * kBlockSize + x - x0; }
};

/// A pixel of a window, or kLanes pixels in a row (Number: float or Lanes). All numbers are 0 beyond the image.
template <typename Number>
struct BlockPixel {
  Number normal[3];
  Number position[3];
  Number light[3];
  Number weight;    ///< root of the sample count; 0: takes no part
  Number filtered;  ///< 1, or 0: no surface to filter
  Number known;     ///< 1, or 0: variance unknown
  Number variance;  ///< variance of the light's luminance if known, else 0
};

/// Components of buffers at a pixel, or at kLanes pixels.
template <typename Number>
struct BufferValues {
  Number position[3];
  Number normal[3];
  Number albedo[3];
  Number light[3];
  Number count;   ///< samples in `light`
  Number square;  ///< mean square of the samples' luminance

  RELUME_HD_INLINE BlockPixel<Number> pixel() const {
    const Number zero(0.0f);
    const Number one(1.0f);
    BlockPixel<Number> p;
    p.filtered = select(max(max(albedo[0], albedo[1]), albedo[2]) < Number(kLeastAlbedo), zero, one);
    const Number samples = count * p.filtered;
    for (int c = 0; c < 3; ++c) {
      p.position[c] = position[c] * p.filtered;
      p.normal[c] = normal[c] * p.filtered;
      p.light[c] = select(zero < samples, light[c], zero);
    }
    const Number y = luminance(p.light[0], p.light[1], p.light[2]);
    p.weight = square_root(samples);
    p.known = select(samples < Number(static_cast<float>(kKnownSamples)), zero, one);
    p.variance = p.known * max(square - y * y, zero) / max(samples - one, one);
    return p;
  }
};

/// Feature f from the components normal(c) and position(c).
template <typename Number, typename Normal, typename Position>
RELUME_HD_INLINE Number block_feature(int f, const Normal& normal, const Position& position) {
  if (f == 0) return Number(1.0f);
  if (f < 4) return normal(f - 1);
  const Number x = position((f - 4) % 3);
  return f < 7 ? x : x * x;
}

/// Maps the range of one component of the positions to [−1, 1].
struct PositionScale {
  static constexpr float kFar = 1e30f;  ///< larger than any position, metres

  float middle;
  float scale;

  RELUME_HD static PositionScale of_range(float low, float high) {
    const float extent = high - low;
    return {0.5f * (low + high), extent > 0.0f ? 2.0f / extent : 0.0f};
  }
};

/// Buffers and settings of the regression.
struct RegressionInput {
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

  RELUME_HD BlockWindow window(uint32_t block_x, uint32_t block_y) const {
    BlockWindow w;
    w.written = {start(block_x, shift_x, width), start(block_y, shift_y, height), start(block_x + 1, shift_x, width),
                 start(block_y + 1, shift_y, height)};
    if (w.empty()) return w;
    w.x0 = origin(w.written.x0, w.written.x1, width);
    w.y0 = origin(w.written.y0, w.written.y1, height);
    w.columns = relume::min(width - w.x0, kBlockSize);
    w.rows = relume::min(height - w.y0, kBlockSize);
    return w;
  }

  RELUME_HD float count_at(uint32_t pixel) const {
    return relume::min(static_cast<float>(static_cast<int>(samples[pixel])), most_samples);
  }

  /// Pixel i of a window.
  RELUME_HD BlockPixel<float> pixel(const BlockWindow& w, uint32_t i) const {
    const uint32_t x = i % kBlockSize;
    const uint32_t y = i / kBlockSize;
    if (x >= w.columns || y >= w.rows) return {};
    const uint32_t at = (w.y0 + y) * width + w.x0 + x;
    BufferValues<float> values;
    for (int c = 0; c < 3; ++c) {
      values.position[c] = position[at][c];
      values.normal[c] = normal[at][c];
      values.albedo[c] = albedo[at][c];
      values.light[c] = light[at][c];
    }
    values.count = count_at(at);
    values.square = square[at];
    return values.pixel();
  }

  /// Share of the difference of light and fit that noise does not explain, in a cell with these sums of squared
  /// differences and of variances (Wiener's filter). May be negative.
  RELUME_HD float detail_share(float differences, float variances) const {
    return differences > 0.0f ? 1.0f - detail * variances / differences : 0.0f;
  }

  /// Writes the fit of a pixel.
  RELUME_HD void write(uint32_t x, uint32_t y, const Rgb& value) const {
    const Rgb fit = glm::max(value, Rgb(0));
    Rgb& average = fitted[y * width + x];
    average = share < 1.0f ? average + (fit - average) * share : fit;
  }

 private:
  RELUME_HD static uint32_t start(uint32_t block, uint32_t shift, uint32_t size) {
    const uint32_t unshifted = block * kBlockSize;
    return unshifted < shift ? 0u : (unshifted - shift < size ? unshifted - shift : size);
  }
  /// First pixel of a block's window.
  RELUME_HD static uint32_t origin(uint32_t first, uint32_t last, uint32_t size) {
    if (first == 0 || size <= kBlockSize) return 0;
    return last == size ? size - kBlockSize : first;
  }
};

}  // namespace relume
