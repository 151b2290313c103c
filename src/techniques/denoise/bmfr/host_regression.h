// The regression of one block on the host: all pixels of the block at once, by lanes. The same bits as
// BlockRegressionKernel in a group.
#pragma once

#include "techniques/denoise/bmfr/regression_input.h"

namespace relume {

/// A block's pixels by columns, and the steps of the regression on them.
class HostRegression {
 public:
  explicit HostRegression(const RegressionInput& input) : in_(input) {}

  void run(uint32_t block_x, uint32_t block_y) {
    const BlockWindow window = in_.window(block_x, block_y);
    if (window.empty() || !gather(window)) return;
    evaluate(solve());
    if (in_.detail > 0.0f) restore_details();
    scatter(window);
  }

 private:
  /// Loads the block's pixels. False if none is filtered.
  bool gather(const BlockWindow& window) {
    if (window.columns < kBlockSize || window.rows < kBlockSize) p_ = {};
    for (uint32_t y = 0; y < window.rows; ++y)
      gather_row((window.y0 + y) * in_.width + window.x0, y * kBlockSize, window.columns);
    float low[3];
    float high[3];
    for (int c = 0; c < 3; ++c) range_of(c, low[c], high[c]);
    if (!(low[0] <= high[0])) return false;
    for (int c = 0; c < 3; ++c) normalise(PositionScale::of_range(low[c], high[c]), p_.position[c]);
    return true;
  }

  /// Loads `count` pixels of the image from `pixel` on into the block, from `first` on.
  void gather_row(uint32_t pixel, uint32_t first, uint32_t count) {
    uint32_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      float numbers[kLanes];
      for (uint32_t k = 0; k < kLanes; ++k) numbers[k] = in_.count_at(pixel + i + k);
      put(first + i, &in_.position[pixel + i].x, &in_.normal[pixel + i].x, &in_.albedo[pixel + i].r,
          &in_.light[pixel + i].r, numbers, &in_.square[pixel + i]);
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
        values[0][3 * k + c] = in_.position[from][component];
        values[1][3 * k + c] = in_.normal[from][component];
        values[2][3 * k + c] = in_.albedo[from][component];
        values[3][3 * k + c] = in_.light[from][component];
      }
      numbers[k] = in_.count_at(from);
      squares[k] = in_.square[from];
    }
    put(first + i, values[0], values[1], values[2], values[3], numbers, squares);
  }

  /// Stores kLanes pixels of the buffers at index `i` of the block.
  RELUME_HD_INLINE void put(uint32_t i, const float* positions, const float* normals, const float* albedos,
                            const float* lights, const float* counts, const float* squares) {
    BufferValues<Lanes> values;
    load_vectors(positions, values.position);
    load_vectors(normals, values.normal);
    load_vectors(albedos, values.albedo);
    load_vectors(lights, values.light);
    values.count = load_lanes(counts);
    values.square = load_lanes(squares);
    const BlockPixel<Lanes> pixel = values.pixel();
    for (int c = 0; c < 3; ++c) {
      store_lanes(p_.position[c] + i, pixel.position[c]);
      store_lanes(p_.normal[c] + i, pixel.normal[c]);
      store_lanes(p_.light[c] + i, pixel.light[c]);
    }
    store_lanes(p_.filtered + i, pixel.filtered);
    store_lanes(p_.weight + i, pixel.weight);
    store_lanes(p_.known + i, pixel.known);
    store_lanes(p_.variance + i, pixel.variance);
  }

  /// Range of a position's component over filtered pixels; low above high without any.
  void range_of(int c, float& low, float& high) const {
    const Lanes one(1.0f);
    const Lanes far(PositionScale::kFar);
    Lanes highest(-PositionScale::kFar);
    Lanes lowest_negated = highest;
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes) {
      const Lanes x = load_lanes(p_.position[c] + i);
      const Lanes away = (one - load_lanes(p_.filtered + i)) * far;
      highest = max(highest, x - away);
      lowest_negated = max(lowest_negated, 0.0f - x - away);
    }
    low = PositionScale::kFar;
    high = -PositionScale::kFar;
    for (uint32_t i = 0; i < kLanes; ++i) {
      low = relume::min(low, -lowest_negated[i]);
      high = relume::max(high, highest[i]);
    }
  }

  static void normalise(const PositionScale& range, float (&position)[kBlockPixels]) {
    const Lanes middle(range.middle);
    const Lanes scale(range.scale);
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes)
      store_lanes(position + i, (load_lanes(position + i) - middle) * scale);
  }

  /// Feature f of kLanes pixels.
  RELUME_HD_INLINE Lanes feature(int f, uint32_t i) const {
    return block_feature<Lanes>(
        f, [&](int c) { return load_lanes(p_.normal[c] + i); }, [&](int c) { return load_lanes(p_.position[c] + i); });
  }

  BlockFit solve() const {
    BlockRegression regression;
    regression.begin();
    const Lanes scale(in_.noise_scale);
    for (uint32_t first = 0; first < kBlockPixels; first += BlockPanel::kPanelRows) {
      for (int f = 0; f < kBlockColumns; ++f) {
        float* column = regression.columns[f] + BlockPanel::kTriangle;
        for (uint32_t i = first; i < first + BlockPanel::kPanelRows; i += kLanes, column += kLanes) {
          Lanes value = f < kBlockFeatures ? feature(f, i) : load_lanes(p_.light[f - kBlockFeatures] + i);
          if (f > 0 && f < kBlockFeatures)
            value = value + scale * load_lanes(in_.noise.data + static_cast<uint32_t>(f - 1) * kBlockPixels + i);
          store_lanes(column, value * load_lanes(p_.weight + i));
        }
      }
      regression.add_panel();
    }
    return regression.fit();
  }

  void evaluate(const BlockFit& fit) {
    for (uint32_t i = 0; i < kBlockPixels; i += kLanes) {
      Lanes sums[3] = {Lanes(0.0f), Lanes(0.0f), Lanes(0.0f)};
      for (int f = 0; f < kBlockFeatures; ++f) {
        const Lanes value = feature(f, i);
        for (int c = 0; c < 3; ++c) sums[c] = sums[c] + value * fit.coefficients[c][f];
      }
      for (int c = 0; c < 3; ++c) store_lanes(p_.fit[c] + i, sums[c]);
    }
  }

  /// Puts back the share of the difference of light and fit that noise does not explain, cell by cell.
  void restore_details() {
    for (uint32_t top = 0; top < kBlockSize; top += kDetailCell) {
      for (uint32_t left = 0; left < kBlockSize; left += kDetailCell) restore_cell(top * kBlockSize + left);
    }
  }

  /// Restores the cell whose first pixel is `first`.
  void restore_cell(uint32_t first) {
    static_assert(kDetailCell == kLanes);
    constexpr uint32_t kEnd = kDetailCell * kBlockSize;
    Lanes differences(0.0f);
    Lanes variances(0.0f);
    for (uint32_t i = first; i < first + kEnd; i += kBlockSize) {
      Lanes left_over[3];
      for (int c = 0; c < 3; ++c) left_over[c] = load_lanes(p_.light[c] + i) - load_lanes(p_.fit[c] + i);
      const Lanes y = luminance(left_over[0], left_over[1], left_over[2]) * load_lanes(p_.known + i);
      differences = differences + y * y;
      variances = variances + load_lanes(p_.variance + i);
    }
    const float kept = in_.detail_share(sum_of(differences), sum_of(variances));
    if (!(kept > 0.0f)) return;
    for (uint32_t i = first; i < first + kEnd; i += kBlockSize) {
      const Lanes share_kept = kept * load_lanes(p_.known + i);
      for (int c = 0; c < 3; ++c) {
        const Lanes fit = load_lanes(p_.fit[c] + i);
        store_lanes(p_.fit[c] + i, fit + (load_lanes(p_.light[c] + i) - fit) * share_kept);
      }
    }
  }

  void scatter(const BlockWindow& window) const {
    for (uint32_t y = window.written.y0; y < window.written.y1; ++y) {
      for (uint32_t x = window.written.x0; x < window.written.x1; ++x) {
        const uint32_t i = window.index(x, y);
        in_.write(x, y, Rgb(p_.fit[0][i], p_.fit[1][i], p_.fit[2][i]));
      }
    }
  }

  /// The members of BlockPixel, by columns, and the fit.
  struct Columns {
    alignas(64) float normal[3][kBlockPixels];
    alignas(64) float position[3][kBlockPixels];
    alignas(64) float light[3][kBlockPixels];
    alignas(64) float fit[3][kBlockPixels];
    alignas(64) float weight[kBlockPixels];
    alignas(64) float filtered[kBlockPixels];
    alignas(64) float known[kBlockPixels];
    alignas(64) float variance[kBlockPixels];
  };

  const RegressionInput& in_;
  Columns p_;
};

}  // namespace relume
