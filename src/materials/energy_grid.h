// Coordinates and interpolation of the albedo tables in this folder.
#pragma once

#include "core/vec.h"

namespace relume::energy_grid {

inline constexpr float kMinR = 0.0316227766f;  ///< √kMinAlpha

/// Rows lie over r = √α from √kMinAlpha to 1, denser at the smooth end. Within a row, the albedo falls near cos θ = α,
/// while Schlick's term changes over all of cos θ. Columns therefore follow the mean of √cos θ and a curve that is half
/// way at √cos θ = 1.5 r.
RELUME_HD inline float row_from_r(float r) { return safe_sqrt((r - kMinR) * (1.0f / (1.0f - kMinR))); }
RELUME_HD inline float r_from_row(float y) { return kMinR + (1.0f - kMinR) * y * y; }
RELUME_HD inline float column_from_cosine(float cos_theta, float r) {
  const float s = safe_sqrt(cos_theta);
  const float k = 1.5f * r;
  return 0.5f * s * (1.0f + (1.0f + k) / (s + k));
}

/// Inverse of column_from_cosine by bisection.
inline float cosine_from_column(float x, float r) {
  float low = 0;
  float high = 1;
  for (int i = 0; i < 40; ++i) {
    const float middle = 0.5f * (low + high);
    (column_from_cosine(middle, r) < x ? low : high) = middle;
  }
  return 0.5f * (low + high);
}

/// Two neighbouring entries along one axis.
struct Cell {
  uint32_t index;
  float fraction;
};

/// Cell of x in [0, 1] among `size` entries.
RELUME_HD inline Cell cell(float x, uint32_t size) {
  const float scaled = saturate(x) * static_cast<float>(size - 1);
  uint32_t i = static_cast<uint32_t>(scaled);
  if (i > size - 2) i = size - 2;
  return {i, scaled - static_cast<float>(i)};
}

}  // namespace relume::energy_grid
