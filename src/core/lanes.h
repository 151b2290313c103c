// Eight floats side by side: a vector register on the host, plain code on a device. Each lane is computed
// independently, so lanes and single floats give the same bits. Code for a number type runs with float and with Lanes.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/hd.h"

namespace relume {

inline constexpr uint32_t kLanes = 8;

namespace lanes_detail {

#if defined(__CUDACC__)

template <typename Number>
struct Register {
  Number values[kLanes];

  RELUME_HD const Number& operator[](uint32_t i) const { return values[i]; }
  RELUME_HD Number& operator[](uint32_t i) { return values[i]; }
};
using Floats = Register<float>;
using Bools = Register<bool>;

/// Applies f lane by lane.
template <typename Result, typename Function, typename... Registers>
RELUME_HD_INLINE Result each(const Function& f, const Registers&... registers) {
  Result result;
  for (uint32_t i = 0; i < kLanes; ++i) result[i] = f(registers[i]...);
  return result;
}

#else

using Floats = float __attribute__((vector_size(4 * kLanes)));
using Bools = int32_t __attribute__((vector_size(4 * kLanes)));  // all bits of a lane are set, or none

/// Applies f to whole registers.
template <typename Result, typename Function, typename... Registers>
RELUME_HD_INLINE Result each(const Function& f, const Registers&... registers) {
  return f(registers...);
}

#endif

}  // namespace lanes_detail

/// Result of comparing lanes.
struct LaneMask {
  lanes_detail::Bools b;

  RELUME_HD_INLINE friend LaneMask operator&(const LaneMask& m, const LaneMask& n) {
    return {lanes_detail::each<lanes_detail::Bools>([](const auto& x, const auto& y) { return x & y; }, m.b, n.b)};
  }
  RELUME_HD_INLINE friend LaneMask operator|(const LaneMask& m, const LaneMask& n) {
    return {lanes_detail::each<lanes_detail::Bools>([](const auto& x, const auto& y) { return x | y; }, m.b, n.b)};
  }
  RELUME_HD_INLINE friend LaneMask operator!(const LaneMask& m) {
    return {lanes_detail::each<lanes_detail::Bools>([](const auto& x) { return x == 0; }, m.b)};
  }
};

struct Lanes {
  lanes_detail::Floats v;

  Lanes() = default;
  RELUME_HD_INLINE Lanes(float x) : v{x, x, x, x, x, x, x, x} {}  // NOLINT: constants mix with lanes
  RELUME_HD_INLINE explicit Lanes(const lanes_detail::Floats& values) : v(values) {}

  RELUME_HD_INLINE float operator[](uint32_t i) const { return v[i]; }

  RELUME_HD_INLINE friend Lanes operator+(const Lanes& a, const Lanes& b) {
    return each([](const auto& x, const auto& y) { return x + y; }, a.v, b.v);
  }
  RELUME_HD_INLINE friend Lanes operator-(const Lanes& a, const Lanes& b) {
    return each([](const auto& x, const auto& y) { return x - y; }, a.v, b.v);
  }
  RELUME_HD_INLINE friend Lanes operator*(const Lanes& a, const Lanes& b) {
    return each([](const auto& x, const auto& y) { return x * y; }, a.v, b.v);
  }
  RELUME_HD_INLINE friend Lanes operator/(const Lanes& a, const Lanes& b) {
    return each([](const auto& x, const auto& y) { return x / y; }, a.v, b.v);
  }
  RELUME_HD_INLINE friend Lanes operator-(const Lanes& a) {
    return each([](const auto& x) { return -x; }, a.v);
  }
  RELUME_HD_INLINE friend LaneMask operator<(const Lanes& a, const Lanes& b) {
    return {lanes_detail::each<lanes_detail::Bools>([](const auto& x, const auto& y) { return x < y; }, a.v, b.v)};
  }
  RELUME_HD_INLINE friend LaneMask operator>(const Lanes& a, const Lanes& b) { return b < a; }
  RELUME_HD_INLINE friend LaneMask operator<=(const Lanes& a, const Lanes& b) {
    return {lanes_detail::each<lanes_detail::Bools>([](const auto& x, const auto& y) { return x <= y; }, a.v, b.v)};
  }

 private:
  template <typename Function, typename... Registers>
  RELUME_HD_INLINE static Lanes each(const Function& f, const Registers&... registers) {
    return Lanes(lanes_detail::each<lanes_detail::Floats>(f, registers...));
  }
};

/// Numbers of kernels where several at once are only faster on the host: lanes on the host, one number on a device,
/// whose threads would keep lanes in memory. Both give the same bits.
#if RELUME_DEVICE_CODE
using HostLanes = float;
#else
using HostLanes = Lanes;
#endif

/// Count of numbers in a T: kLanes, or 1 for float.
template <typename T>
inline constexpr uint32_t kWidthOf = sizeof(T) / sizeof(float);

/// The mask whose lane i is set if condition(i) holds.
template <typename Condition>
RELUME_HD_INLINE LaneMask mask_of(const Condition& condition) {
  LaneMask mask;
  for (uint32_t i = 0; i < kLanes; ++i) mask.b[i] = condition(i) ? ~0 : 0;
  return mask;
}
/// Whether any lane is set.
RELUME_HD_INLINE bool any_of(const LaneMask& mask) {
  bool any = false;
  for (uint32_t i = 0; i < kLanes; ++i) any |= mask.b[i] != 0;
  return any;
}

/// Result of comparing numbers of type T.
template <typename T>
using MaskOf = decltype(T() < T());

/// `yes` where the condition is true, `no` elsewhere.
RELUME_HD_INLINE constexpr float select(bool condition, float yes, float no) { return condition ? yes : no; }
RELUME_HD_INLINE Lanes select(const LaneMask& condition, const Lanes& yes, const Lanes& no) {
  return Lanes(lanes_detail::each<lanes_detail::Floats>(
      [](const auto& c, const auto& x, const auto& y) { return c ? x : y; }, condition.b, yes.v, no.v));
}
RELUME_HD_INLINE Lanes max(const Lanes& a, const Lanes& b) { return select(a > b, a, b); }
RELUME_HD_INLINE Lanes min(const Lanes& a, const Lanes& b) { return select(a < b, a, b); }

RELUME_HD_INLINE float square_root(float x) { return std::sqrt(x); }
RELUME_HD_INLINE Lanes square_root(const Lanes& a) {
  Lanes result;
  for (uint32_t i = 0; i < kLanes; ++i) result.v[i] = std::sqrt(a[i]);
  return result;
}

/// Floor of each lane.
RELUME_HD_INLINE Lanes floor_of(const Lanes& a) {
  Lanes result;
  for (uint32_t i = 0; i < kLanes; ++i) result.v[i] = std::floor(a[i]);
  return result;
}

RELUME_HD_INLINE float absolute(float x) { return std::fabs(x); }
RELUME_HD_INLINE Lanes absolute(const Lanes& a) { return max(a, 0.0f - a); }

/// Loads and stores have no alignment requirement.
template <typename T = Lanes>
RELUME_HD_INLINE T load_lanes(const float* from) {
  T lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
template <typename T>
RELUME_HD_INLINE void store_lanes(float* to, const T& lanes) {
  std::memcpy(to, &lanes, sizeof lanes);
}

/// Loads eight rows of a table of eight columns: columns[c] holds table[8 · rows[0 … 7] + c].
RELUME_HD_INLINE void load_rows(const float* table, const uint32_t (&rows)[kLanes], Lanes (&columns)[kLanes]) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < kLanes; ++c) columns[c].v[i] = table[kLanes * rows[i] + c];
  }
#else
  // Transposes 2 × 2, 4 × 4 and 8 × 8 blocks.
  lanes_detail::Floats a[kLanes];
  lanes_detail::Floats b[kLanes];
  for (uint32_t i = 0; i < kLanes; ++i) a[i] = load_lanes(table + size_t{kLanes} * rows[i]).v;
  for (uint32_t i = 0; i < kLanes; i += 2) {
    b[i] = __builtin_shufflevector(a[i], a[i + 1], 0, 8, 2, 10, 4, 12, 6, 14);
    b[i + 1] = __builtin_shufflevector(a[i], a[i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  for (uint32_t i = 0; i < kLanes; i += 4) {
    for (uint32_t k = 0; k < 2; ++k) {
      a[i + k] = __builtin_shufflevector(b[i + k], b[i + k + 2], 0, 1, 8, 9, 4, 5, 12, 13);
      a[i + k + 2] = __builtin_shufflevector(b[i + k], b[i + k + 2], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (uint32_t k = 0; k < 4; ++k) {
    columns[k].v = __builtin_shufflevector(a[k], a[k + 4], 0, 1, 2, 3, 8, 9, 10, 11);
    columns[k + 4].v = __builtin_shufflevector(a[k], a[k + 4], 4, 5, 6, 7, 12, 13, 14, 15);
  }
#endif
}

/// Loads eight consecutive vectors, separated by component.
RELUME_HD_INLINE void load_vectors(const float* from, Lanes (&v)[3]) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < 3; ++c) v[c].v[i] = from[3 * i + c];
  }
#else
  const auto a = load_lanes(from).v;
  const auto b = load_lanes(from + kLanes).v;
  const auto c = load_lanes(from + 2 * kLanes).v;
  v[0].v =
      __builtin_shufflevector(__builtin_shufflevector(a, b, 0, 3, 6, 9, 12, 15, 0, 0), c, 0, 1, 2, 3, 4, 5, 10, 13);
  v[1].v =
      __builtin_shufflevector(__builtin_shufflevector(a, b, 1, 4, 7, 10, 13, 0, 0, 0), c, 0, 1, 2, 3, 4, 8, 11, 14);
  v[2].v =
      __builtin_shufflevector(__builtin_shufflevector(a, b, 2, 5, 8, 11, 14, 0, 0, 0), c, 0, 1, 2, 3, 4, 9, 12, 15);
#endif
}

/// Stores eight consecutive vectors from their components.
RELUME_HD_INLINE void store_vectors(float* to, const Lanes& x, const Lanes& y, const Lanes& z) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    to[3 * i] = x[i];
    to[3 * i + 1] = y[i];
    to[3 * i + 2] = z[i];
  }
#else
  const auto a = __builtin_shufflevector(x.v, y.v, 0, 8, 0, 1, 9, 0, 2, 10);
  const auto b = __builtin_shufflevector(x.v, y.v, 0, 3, 11, 0, 4, 12, 0, 5);
  const auto c = __builtin_shufflevector(x.v, y.v, 13, 0, 6, 14, 0, 7, 15, 0);
  store_lanes(to, __builtin_shufflevector(a, z.v, 0, 1, 8, 3, 4, 9, 6, 7));
  store_lanes(to + kLanes, __builtin_shufflevector(b, z.v, 10, 1, 2, 11, 4, 5, 12, 7));
  store_lanes(to + 2 * kLanes, __builtin_shufflevector(c, z.v, 0, 13, 2, 3, 14, 5, 6, 15));
#endif
}

/// Loads eight consecutive pairs, separated by component.
RELUME_HD_INLINE void load_pairs(const float* from, Lanes (&v)[2]) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    for (uint32_t c = 0; c < 2; ++c) v[c].v[i] = from[2 * i + c];
  }
#else
  const auto a = load_lanes(from).v;
  const auto b = load_lanes(from + kLanes).v;
  v[0].v = __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14);
  v[1].v = __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15);
#endif
}

/// Stores eight consecutive pairs from their components.
RELUME_HD_INLINE void store_pairs(float* to, const Lanes& x, const Lanes& y) {
#if defined(__CUDACC__)
  for (uint32_t i = 0; i < kLanes; ++i) {
    to[2 * i] = x[i];
    to[2 * i + 1] = y[i];
  }
#else
  store_lanes(to, __builtin_shufflevector(x.v, y.v, 0, 8, 1, 9, 2, 10, 3, 11));
  store_lanes(to + kLanes, __builtin_shufflevector(x.v, y.v, 4, 12, 5, 13, 6, 14, 7, 15));
#endif
}

/// Relative luminance, as for Rgb (core/vec.h).
RELUME_HD_INLINE float luminance(float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; }
RELUME_HD_INLINE Lanes luminance(const Lanes& r, const Lanes& g, const Lanes& b) {
  return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

/// Sum of all lanes in a fixed order.
RELUME_HD_INLINE float sum_of(const Lanes& a) {
  return ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]));
}

}  // namespace relume
