// Least squares over one block of pixels: finds the combination of features that is closest to the measured light
// ([Koskela19] §3.3). Householder's QR decomposition treats columns in strips, which vectorise. A block arrives in
// panels that fit into the nearest cache. Each panel is reduced together with the triangle of the earlier ones.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/lanes.h"

namespace relume {

inline constexpr uint32_t kBlockSize = 32;
inline constexpr uint32_t kBlockPixels = kBlockSize * kBlockSize;

/// 1, normal, position, squared position; positions lie in [−1, 1]³.
inline constexpr int kBlockFeatures = 10;
/// The features and three channels of light.
inline constexpr int kBlockColumns = kBlockFeatures + 3;

/// Coefficients of the features for each channel.
struct BlockFit {
  float coefficients[3][kBlockFeatures];
};

/// Minimises the sum of squared differences between the rows' light and one combination of their features.
struct BlockRegression {
  static constexpr uint32_t kTriangle = 16;  ///< first rows: triangle of the earlier panels
  static constexpr uint32_t kPanelRows = 256;
  static constexpr uint32_t kRows = kTriangle + kPanelRows;

  /// Row kTriangle + i is pixel i of the panel: features, then light. The caller sets all of them for each panel.
  alignas(64) float columns[kBlockColumns][kRows];

  /// Call before the first panel.
  RELUME_HD void begin() {
    for (auto& column : columns) {
      for (uint32_t i = 0; i < kTriangle; ++i) column[i] = 0.0f;
    }
  }

  /// Reduces the panel to a triangle.
  RELUME_HD void add_panel() {
    float r[kBlockFeatures][kBlockColumns] = {};
    float lengths[kBlockFeatures];
    for (int k = 0; k < kBlockFeatures; ++k) lengths[k] = squared_length(columns[k]);
    for (int k = 0; k < kBlockFeatures; ++k) eliminate(k, lengths[k], r[k]);
    for (int c = 0; c < kBlockColumns; ++c) {
      for (int k = 0; k < static_cast<int>(kTriangle); ++k) columns[c][k] = k < kBlockFeatures ? r[k][c] : 0.0f;
    }
  }

  /// Fit of all panels so far. Features that depend on earlier ones get 0.
  RELUME_HD BlockFit fit() const {
    BlockFit result;
    for (int channel = 0; channel < 3; ++channel) {
      float* x = result.coefficients[channel];
      for (int k = kBlockFeatures - 1; k >= 0; --k) {
        x[k] = 0.0f;
        if (columns[k][k] == 0.0f) continue;
        float sum = columns[kBlockFeatures + channel][k];
        for (int c = k + 1; c < kBlockFeatures; ++c) sum -= columns[c][k] * x[c];
        x[k] = sum / columns[k][k];
      }
    }
    return result;
  }

 private:
  /// A column with less than this fraction of its squared length left depends on earlier columns.
  static constexpr float kDependent = 1e-9f;

  /// Reflects column k onto its diagonal and moves row k into `r`, which leaves zeros for later steps.
  RELUME_HD_INLINE void eliminate(int k, float length_before, float (&r)[kBlockColumns]) {
    float* v = columns[k];
    const float square = squared_length(v);
    if (!(square > kDependent * length_before)) return;
    const float length = std::sqrt(square);
    const float diagonal = v[k] > 0.0f ? -length : length;
    const float scale = 1.0f / (square + length * std::fabs(v[k]));
    v[k] -= diagonal;
    int c = k + 1;
    for (; c + 4 <= kBlockColumns; c += 4) reflect<4>(v, scale, columns + c);
    for (; c < kBlockColumns; ++c) reflect<1>(v, scale, columns + c);
    r[k] = diagonal;
    for (c = k + 1; c < kBlockColumns; ++c) {
      r[c] = columns[c][k];
      columns[c][k] = 0.0f;
    }
  }

  RELUME_HD_INLINE static float squared_length(const float* a) {
    Lanes even(0.0f);
    Lanes odd(0.0f);
    for (uint32_t i = 0; i < kRows; i += 2 * kLanes) {
      const Lanes first = load_lanes(a + i);
      const Lanes second = load_lanes(a + i + kLanes);
      even = even + first * first;
      odd = odd + second * second;
    }
    return sum_of(even + odd);
  }

  /// Reflects kCount columns: a −= scale (v · a) v. Each load of v serves all of them.
  template <int kCount>
  RELUME_HD_INLINE static void reflect(const float* v, float scale, float (*a)[kRows]) {
    Lanes sums[kCount];
    for (int c = 0; c < kCount; ++c) sums[c] = Lanes(0.0f);
    for (uint32_t i = 0; i < kRows; i += kLanes) {
      const Lanes vi = load_lanes(v + i);
      for (int c = 0; c < kCount; ++c) sums[c] = sums[c] + vi * load_lanes(a[c] + i);
    }
    for (int c = 0; c < kCount; ++c) sums[c] = Lanes(scale * sum_of(sums[c]));
    for (uint32_t i = 0; i < kRows; i += kLanes) {
      const Lanes vi = load_lanes(v + i);
      for (int c = 0; c < kCount; ++c) store_lanes(a[c] + i, load_lanes(a[c] + i) - sums[c] * vi);
    }
  }
};

}  // namespace relume
