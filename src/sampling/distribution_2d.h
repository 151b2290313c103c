// Piecewise-constant densities over the unit square.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Density proportional to the value of a width × height grid; cell (i, j) covers [i, i+1)/width × [j, j+1)/height.
/// Sampling inverts marginal and conditional CDFs, which preserves the stratification of the random numbers.
struct Distribution2D {
  View<const float> marginal;     ///< height + 1 values, from 0 to 1
  View<const float> conditional;  ///< height rows of width + 1 values, each from 0 to 1
  uint32_t width = 0;
  uint32_t height = 0;

  struct Sample {
    Vec2 point;
    float pdf;  ///< over the unit square
  };

  RELUME_HD bool empty() const { return width == 0; }

  RELUME_HD Sample sample(const Vec2& u) const {
    float dy;
    float dx;
    const uint32_t j = find(marginal.data, height, u.y, &dy);
    const float* row = row_of(j);
    const uint32_t i = find(row, width, u.x, &dx);
    return {{(static_cast<float>(i) + dx) / static_cast<float>(width),
             (static_cast<float>(j) + dy) / static_cast<float>(height)},
            cell_pdf(i, j)};
  }

  /// Density at a point of [0, 1)².
  RELUME_HD float pdf(const Vec2& p) const { return cell_pdf(cell(p.x, width), cell(p.y, height)); }

  /// Random numbers that sample() maps to `p`.
  RELUME_HD Vec2 inverse(const Vec2& p) const {
    const uint32_t i = cell(p.x, width);
    const uint32_t j = cell(p.y, height);
    const float* row = row_of(j);
    const float fx = p.x * static_cast<float>(width) - static_cast<float>(i);
    const float fy = p.y * static_cast<float>(height) - static_cast<float>(j);
    return {lerp(row[i], row[i + 1], fx), lerp(marginal[j], marginal[j + 1], fy)};
  }

 private:
  RELUME_HD const float* row_of(uint32_t j) const { return conditional.data + static_cast<size_t>(j) * (width + 1); }

  RELUME_HD static uint32_t cell(float x, uint32_t count) {
    const float scaled = x * static_cast<float>(count);
    const uint32_t i = scaled > 0.0f ? static_cast<uint32_t>(scaled) : 0u;
    return i < count ? i : count - 1;
  }

  RELUME_HD float cell_pdf(uint32_t i, uint32_t j) const {
    const float* row = row_of(j);
    return (row[i + 1] - row[i]) * static_cast<float>(width) * (marginal[j + 1] - marginal[j]) *
           static_cast<float>(height);
  }

  /// Last i with cdf[i] <= u among the cells of non-zero width, and the relative position of u in it.
  RELUME_HD static uint32_t find(const float* cdf, uint32_t count, float u, float* fraction) {
    uint32_t low = 0;
    uint32_t high = count;
    while (low + 1 < high) {
      const uint32_t middle = (low + high) / 2;
      if (cdf[middle] <= u) {
        low = middle;
      } else {
        high = middle;
      }
    }
    const float width = cdf[low + 1] - cdf[low];
    *fraction = width > 0.0f ? clamp((u - cdf[low]) / width, 0.0f, kOneMinusEpsilon) : 0.5f;
    return low;
  }
};

/// Arrays of a Distribution2D.
struct Distribution2DStorage {
  std::vector<float> marginal;
  std::vector<float> conditional;
  uint32_t width = 0;
  uint32_t height = 0;

  Distribution2D view() const { return {view_of(marginal), view_of(conditional), width, height}; }
};

/// Builds a distribution of `values` ≥ 0 in rows of `width`; empty if their sum is zero or not finite.
Distribution2DStorage build_distribution_2d(std::span<const float> values, uint32_t width, uint32_t height);

}  // namespace relume
