// Least squares over one block of pixels: finds the combination of features that is closest to the measured light
// ([Koskela19] §3.3). Householder's QR decomposition treats columns in strips, which vectorise. A block arrives in
// panels that fit into the nearest cache, or into the shared memory of a group. Each panel is reduced together with the
// triangle of the earlier ones.
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

/// A panel below the triangle of the earlier ones, by columns: features, then light.
struct BlockPanel {
  static constexpr uint32_t kTriangle = 16;  ///< first rows: the triangle
  static constexpr uint32_t kPanelRows = 256;
  static constexpr uint32_t kRows = kTriangle + kPanelRows;

  /// Row kTriangle + i is pixel i of the panel. The caller sets all of them for each panel.
  alignas(64) float columns[kBlockColumns][kRows];

  /// Fit of one channel to all panels so far. Features that depend on earlier ones get 0.
  RELUME_HD void fit_channel(int channel, float (&x)[kBlockFeatures]) const {
    for (int k = kBlockFeatures - 1; k >= 0; --k) {
      x[k] = 0.0f;
      if (columns[k][k] == 0.0f) continue;
      float sum = columns[kBlockFeatures + channel][k];
      for (int c = k + 1; c < kBlockFeatures; ++c) sum -= columns[c][k] * x[c];
      x[k] = sum / columns[k][k];
    }
  }
};

/// Householder's reflection of a column v onto its diagonal. After `diagonal` is subtracted from its diagonal element,
/// it reflects columns a by a −= scale (v · a) v.
struct BlockReflection {
  bool needed;  ///< false: the column depends on earlier ones
  float diagonal;
  float scale;

  /// `square`: squared length of the column; `before`: the same before earlier reflections; `top`: diagonal element.
  RELUME_HD_INLINE BlockReflection(float square, float before, float top) : needed(square > kDependent * before) {
    const float length = std::sqrt(square);
    diagonal = top > 0.0f ? -length : length;
    scale = 1.0f / (square + length * std::fabs(top));
  }

 private:
  /// A column with less than this fraction of its squared length left depends on earlier columns.
  static constexpr float kDependent = 1e-9f;
};

/// Minimises the sum of squared differences between the rows' light and one combination of their features. Lanes are
/// in vector registers.
struct BlockRegression : BlockPanel {
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

  RELUME_HD BlockFit fit() const {
    BlockFit result;
    for (int channel = 0; channel < 3; ++channel) fit_channel(channel, result.coefficients[channel]);
    return result;
  }

 private:
  /// Reflects column k onto its diagonal and moves row k into `r`, which leaves zeros for later steps.
  RELUME_HD_INLINE void eliminate(int k, float length_before, float (&r)[kBlockColumns]) {
    float* v = columns[k];
    const BlockReflection reflection(squared_length(v), length_before, v[k]);
    if (!reflection.needed) return;
    v[k] -= reflection.diagonal;
    int c = k + 1;
    for (; c + 4 <= kBlockColumns; c += 4) reflect<4>(v, reflection.scale, columns + c);
    for (; c < kBlockColumns; ++c) reflect<1>(v, reflection.scale, columns + c);
    r[k] = reflection.diagonal;
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

/// BlockRegression in the shared memory of a group. One thread adds the elements of one lane, so the bits are the same.
struct GroupRegression : BlockPanel {
  /// Call before the first panel.
  template <typename Group>
  RELUME_HD void begin(const Group& group) {
    group.each(kBlockColumns * kTriangle, [this](uint32_t i) { columns[i / kTriangle][i % kTriangle] = 0.0f; });
  }

  /// Reduces the panel to a triangle.
  template <typename Group>
  RELUME_HD void add_panel(const Group& group) {
    group.each(kBlockFeatures * kSquareLanes,
               [this](uint32_t i) { partial[i] = squares(columns[i / kSquareLanes], i % kSquareLanes); });
    group.each(kBlockFeatures, [this](uint32_t k) { lengths[k] = sum_of_squares(partial + k * kSquareLanes); });
    group.each(kBlockFeatures * kBlockColumns, [this](uint32_t i) { r[i / kBlockColumns][i % kBlockColumns] = 0.0f; });
    for (uint32_t k = 0; k < kBlockFeatures; ++k) eliminate(group, k);
    group.each(kBlockColumns * kTriangle, [this](uint32_t i) {
      const uint32_t k = i % kTriangle;
      columns[i / kTriangle][k] = k < kBlockFeatures ? r[k][i / kTriangle] : 0.0f;
    });
  }

 private:
  /// Lanes of a squared length: the even and the odd vectors of a column.
  static constexpr uint32_t kSquareLanes = 2 * kLanes;

  float r[kBlockFeatures][kBlockColumns];        ///< rows of the new triangle
  float lengths[kBlockFeatures];                 ///< squared, before the reflections
  float partial[kBlockFeatures * kSquareLanes];  ///< sums of lanes
  float factors[kBlockColumns];                  ///< of the reflected columns

  template <typename Group>
  RELUME_HD void eliminate(const Group& group, uint32_t k) {
    float* v = columns[k];
    group.each(kSquareLanes, [&](uint32_t lane) { partial[lane] = squares(v, lane); });
    const BlockReflection reflection(sum_of_squares(partial), lengths[k], v[k]);
    if (!reflection.needed) return;
    group.each(1, [&](uint32_t) { v[k] -= reflection.diagonal; });
    float(*a)[kRows] = columns + k + 1;
    const uint32_t count = kBlockColumns - k - 1;
    group.each(count * kLanes, [&](uint32_t i) {
      float sum = 0.0f;
      for (uint32_t row = i % kLanes; row < kRows; row += kLanes) sum += v[row] * a[i / kLanes][row];
      partial[i] = sum;
    });
    group.each(count,
               [&](uint32_t c) { factors[c] = reflection.scale * sum_of(load_lanes(partial + size_t{c} * kLanes)); });
    group.each(kRows, [&](uint32_t row) {
      for (uint32_t c = 0; c < count; ++c) a[c][row] -= factors[c] * v[row];
    });
    group.each(count, [&](uint32_t c) {
      r[k][k + 1 + c] = a[c][k];
      a[c][k] = 0.0f;
      if (c == 0) r[k][k] = reflection.diagonal;
    });
  }

  /// Sum of the squares of one lane.
  RELUME_HD_INLINE static float squares(const float* a, uint32_t lane) {
    float sum = 0.0f;
    for (uint32_t row = lane; row < kRows; row += kSquareLanes) sum += a[row] * a[row];
    return sum;
  }
  RELUME_HD_INLINE static float sum_of_squares(const float* lanes) {
    return sum_of(load_lanes(lanes) + load_lanes(lanes + kLanes));
  }
};

}  // namespace relume
