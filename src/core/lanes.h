// Eight floats side by side: a vector register of the host, plain code on a device. Each lane is computed as if it were
// alone, so the bits are the same either way, and those of the functions for one float.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/hd.h"

namespace relume {

inline constexpr uint32_t kLanes = 8;

#if defined(__CUDACC__)

struct Lanes {
  float values[kLanes];

  RELUME_HD float operator[](uint32_t i) const { return values[i]; }
};

namespace lanes_detail {

template <typename Function>
RELUME_HD inline Lanes each(Function&& function) {
  Lanes result;
  for (uint32_t i = 0; i < kLanes; ++i) result.values[i] = function(i);
  return result;
}

}  // namespace lanes_detail

RELUME_HD inline Lanes lanes_of(float x) {
  return lanes_detail::each([&](uint32_t) { return x; });
}
RELUME_HD inline Lanes operator+(const Lanes& a, const Lanes& b) {
  return lanes_detail::each([&](uint32_t i) { return a[i] + b[i]; });
}
RELUME_HD inline Lanes operator-(const Lanes& a, const Lanes& b) {
  return lanes_detail::each([&](uint32_t i) { return a[i] - b[i]; });
}
RELUME_HD inline Lanes operator*(const Lanes& a, const Lanes& b) {
  return lanes_detail::each([&](uint32_t i) { return a[i] * b[i]; });
}
RELUME_HD inline Lanes operator/(const Lanes& a, const Lanes& b) {
  return lanes_detail::each([&](uint32_t i) { return a[i] / b[i]; });
}
RELUME_HD inline Lanes max(const Lanes& a, const Lanes& b) {
  return lanes_detail::each([&](uint32_t i) { return a[i] > b[i] ? a[i] : b[i]; });
}
RELUME_HD inline Lanes square_root(const Lanes& a) {
  return lanes_detail::each([&](uint32_t i) { return std::sqrt(a[i]); });
}

/// a < b ? x : y.
RELUME_HD inline Lanes select_less(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y) {
  return lanes_detail::each([&](uint32_t i) { return a[i] < b[i] ? x[i] : y[i]; });
}

#else

using Lanes = float __attribute__((vector_size(4 * kLanes)));

RELUME_HD_INLINE Lanes lanes_of(float x) { return Lanes{x, x, x, x, x, x, x, x}; }
RELUME_HD_INLINE Lanes max(const Lanes& a, const Lanes& b) { return a > b ? a : b; }
RELUME_HD_INLINE Lanes select_less(const Lanes& a, const Lanes& b, const Lanes& x, const Lanes& y) {
  return a < b ? x : y;
}
RELUME_HD_INLINE Lanes square_root(const Lanes& a) {
  Lanes result;
  for (uint32_t i = 0; i < kLanes; ++i) result[i] = std::sqrt(a[i]);
  return result;
}

#endif

RELUME_HD_INLINE float square_root(float x) { return std::sqrt(x); }

/// From and to any address.
RELUME_HD_INLINE Lanes load_lanes(const float* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
RELUME_HD_INLINE void store_lanes(float* to, const Lanes& lanes) { std::memcpy(to, &lanes, sizeof lanes); }

/// Eight vectors one after another, by component.
RELUME_HD_INLINE void load_vectors(const float* from, Lanes (&v)[3]) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < 3; ++c) v[c].values[i] = from[3 * i + c];
  }
#else
  const Lanes a = load_lanes(from);
  const Lanes b = load_lanes(from + kLanes);
  const Lanes c = load_lanes(from + 2 * kLanes);
  v[0] = __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, 0, 0), c, 0, 1, 2, 3, 4, 5, 10, 13);
  v[1] = __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 10, 13, 0, 0, 0), c, 0, 1, 2, 3, 4, 8, 11, 14);
  v[2] = __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 8, 11, 14, 0, 0, 0), c, 0, 1, 2, 3, 4, 9, 12, 15);
#endif
}

/// Relative luminance, as of a Rgb (core/vec.h).
RELUME_HD_INLINE float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }
RELUME_HD_INLINE Lanes luminance(const Lanes& r, const Lanes& g, const Lanes& b) {
  return lanes_of(0.2126f) * r + lanes_of(0.7152f) * g + lanes_of(0.0722f) * b;
}

/// Sum of all lanes, in an order of its own.
RELUME_HD_INLINE float sum_of(const Lanes& a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

}  // namespace relume
