// The regression over all blocks of an image ([Koskela19] §3.2, 3.3).
#pragma once

#include "frame/launch.h"
#include "techniques/denoise/bmfr/host_regression.h"

namespace relume {

/// Fills the random numbers, uniform in [−1, 1). Grid: kBlockPixels × (kBlockFeatures − 1).
struct BlockNoiseKernel {
  View<float> noise;
  uint32_t frame = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    noise[y * kBlockPixels + x] = 2.0f * to_unit_float(hash(x, y, frame)) - 1.0f;
  }
};

/// Fits the light of one block per group and writes the fit for its pixels. Grid: blocks(width) × blocks(height). The
/// grid of blocks is shifted from frame to frame. Blocks cut off by the border are fitted to a full window of pixels.
/// A group reads pixels again for each step, because all of them would fill 64 KiB of shared memory.
struct BlockRegressionKernel : RegressionInput {
  static constexpr uint32_t kThreads = 128;

  struct Shared {
    GroupRegression regression;
    BlockFit fit;
    PositionScale scale[3];
    bool filtered;                                                 ///< whether any pixel has a surface to filter
    float extremes[6 * kLanes];                                    ///< maxima of p and −p by lane
    float differences[kDetailCells * kDetailCells * kDetailCell];  ///< by cell and column
    float variances[kDetailCells * kDetailCells * kDetailCell];
    float kept[kDetailCells * kDetailCells];  ///< share of the details by cell; not positive: none
  };

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t block_x, uint32_t block_y) const {
    const BlockWindow w = window(block_x, block_y);
    if (w.empty()) return;
    find_scale(group, shared, w);
    if (!shared.filtered) return;
    solve(group, shared, w);
    weigh_details(group, shared, w);
    const uint32_t columns = w.written.x1 - w.written.x0;
    group.each(columns * (w.written.y1 - w.written.y0), [&](uint32_t i) {
      const uint32_t x = w.written.x0 + i % columns;
      const uint32_t y = w.written.y0 + i / columns;
      write(x, y, detailed(shared, w, w.index(x, y)));
    });
  }

  void on_host(uint32_t block_x, uint32_t block_y) const { HostRegression(*this).run(block_x, block_y); }

 private:
  /// Finds the scale of positions from their range over filtered pixels.
  template <typename Group>
  RELUME_HD void find_scale(const Group& group, Shared& shared, const BlockWindow& w) const {
    auto& columns = shared.regression.columns;
    group.each(6 * kLanes, [&](uint32_t i) { shared.extremes[i] = -PositionScale::kFar; });
    for (uint32_t first = 0; first < kBlockPixels; first += BlockPanel::kPanelRows) {
      group.each(BlockPanel::kPanelRows, [&](uint32_t i) {
        const BlockPixel<float> p = pixel(w, first + i);
        for (int c = 0; c < 3; ++c) columns[c][i] = p.position[c];
        columns[3][i] = (1.0f - p.filtered) * PositionScale::kFar;
      });
      group.each(6 * kLanes, [&](uint32_t i) {
        const float* x = columns[i / kLanes % 3];
        float most = shared.extremes[i];
        for (uint32_t k = i % kLanes; k < BlockPanel::kPanelRows; k += kLanes)
          most = relume::max(most, (i < 3 * kLanes ? x[k] : 0.0f - x[k]) - columns[3][k]);
        shared.extremes[i] = most;
      });
    }
    group.each(3, [&](uint32_t c) {
      float low = PositionScale::kFar;
      float high = -PositionScale::kFar;
      for (uint32_t lane = c * kLanes; lane < (c + 1) * kLanes; ++lane) {
        low = relume::min(low, -shared.extremes[3 * kLanes + lane]);
        high = relume::max(high, shared.extremes[lane]);
      }
      shared.scale[c] = PositionScale::of_range(low, high);
      if (c == 0) shared.filtered = low <= high;
    });
  }

  /// Pixel i of the window, with the position scaled to [−1, 1].
  RELUME_HD BlockPixel<float> scaled_pixel(const Shared& shared, const BlockWindow& w, uint32_t i) const {
    BlockPixel<float> p = pixel(w, i);
    for (int c = 0; c < 3; ++c) p.position[c] = (p.position[c] - shared.scale[c].middle) * shared.scale[c].scale;
    return p;
  }

  RELUME_HD_INLINE static float feature(const BlockPixel<float>& p, int f) {
    return block_feature<float>(
        f, [&](int c) { return p.normal[c]; }, [&](int c) { return p.position[c]; });
  }

  template <typename Group>
  RELUME_HD void solve(const Group& group, Shared& shared, const BlockWindow& w) const {
    GroupRegression& regression = shared.regression;
    regression.begin(group);
    for (uint32_t first = 0; first < kBlockPixels; first += BlockPanel::kPanelRows) {
      group.each(BlockPanel::kPanelRows, [&](uint32_t i) {
        const BlockPixel<float> p = scaled_pixel(shared, w, first + i);
        for (int f = 0; f < kBlockColumns; ++f) {
          float value = f < kBlockFeatures ? feature(p, f) : p.light[f - kBlockFeatures];
          if (f > 0 && f < kBlockFeatures)
            value = value + noise_scale * noise[static_cast<uint32_t>(f - 1) * kBlockPixels + first + i];
          regression.columns[f][BlockPanel::kTriangle + i] = value * p.weight;
        }
      });
      regression.add_panel(group);
    }
    group.each(3, [&](uint32_t channel) {
      regression.fit_channel(static_cast<int>(channel), shared.fit.coefficients[channel]);
    });
  }

  RELUME_HD static Rgb evaluate(const BlockFit& fit, const BlockPixel<float>& p) {
    Rgb sum(0);
    for (int f = 0; f < kBlockFeatures; ++f) {
      const float value = feature(p, f);
      for (int c = 0; c < 3; ++c) sum[c] = sum[c] + value * fit.coefficients[c][f];
    }
    return sum;
  }

  /// Finds the share of the difference of light and fit that noise does not explain, cell by cell. It keeps light that
  /// features cannot express: caustics, shadows, reflections.
  template <typename Group>
  RELUME_HD void weigh_details(const Group& group, Shared& shared, const BlockWindow& w) const {
    constexpr uint32_t kCells = kDetailCells * kDetailCells;
    if (!(detail > 0.0f)) return group.each(kCells, [&](uint32_t cell) { shared.kept[cell] = 0.0f; });
    group.each(kCells * kDetailCell, [&](uint32_t i) {
      const uint32_t cell = i / kDetailCell;
      const uint32_t x = cell % kDetailCells * kDetailCell + i % kDetailCell;
      const uint32_t top = cell / kDetailCells * kDetailCell;
      float differences = 0.0f;
      float variances = 0.0f;
      for (uint32_t y = top; y < top + kDetailCell; ++y) {
        const BlockPixel<float> p = scaled_pixel(shared, w, y * kBlockSize + x);
        const Rgb fit = evaluate(shared.fit, p);
        const float difference = luminance(p.light[0] - fit.r, p.light[1] - fit.g, p.light[2] - fit.b) * p.known;
        differences = differences + difference * difference;
        variances = variances + p.variance;
      }
      shared.differences[i] = differences;
      shared.variances[i] = variances;
    });
    group.each(kCells, [&](uint32_t cell) {
      shared.kept[cell] = detail_share(sum_of(load_lanes(shared.differences + size_t{cell} * kDetailCell)),
                                       sum_of(load_lanes(shared.variances + size_t{cell} * kDetailCell)));
    });
  }

  /// Fit of pixel i of the window, with the details of its cell.
  RELUME_HD Rgb detailed(const Shared& shared, const BlockWindow& w, uint32_t i) const {
    const BlockPixel<float> p = scaled_pixel(shared, w, i);
    Rgb fit = evaluate(shared.fit, p);
    const float kept = shared.kept[i / kBlockSize / kDetailCell * kDetailCells + i % kBlockSize / kDetailCell];
    if (!(kept > 0.0f)) return fit;
    const float share_kept = kept * p.known;
    for (int c = 0; c < 3; ++c) fit[c] = fit[c] + (p.light[c] - fit[c]) * share_kept;
    return fit;
  }
};

}  // namespace relume
