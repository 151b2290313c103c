// Sums whose result does not depend on the order of the summands: real values are rounded once to 64-bit
// integers, and integers are added atomically.
#pragma once

#include <atomic>
#include <cstdint>

#include "core/vec.h"

namespace relume {

/// Adds to a word that several threads share.
template <typename Integer>
RELUME_HD inline void atomic_add(Integer* target, Integer value) {
#if RELUME_DEVICE_CODE
  if constexpr (sizeof(Integer) == 8) {
    atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
  } else {
    atomicAdd(reinterpret_cast<unsigned int*>(target), static_cast<unsigned int>(value));
  }
#else
  std::atomic_ref<Integer>(*target).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Replaces a word that several threads share by `value` if that is smaller.
RELUME_HD inline void atomic_min(uint64_t* target, uint64_t value) {
#if RELUME_DEVICE_CODE
  atomicMin(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<uint64_t> shared(*target);
  uint64_t seen = shared.load(std::memory_order_relaxed);
  while (value < seen && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// Value of one unit of the fixed-point sums of radiance: 2^-24. The largest sum is 2^39.
inline constexpr float kFixedPointUnit = 0x1p-24f;
/// Summands above are clamped, so that 2^19 of them cannot overflow; callers count them as saturated.
inline constexpr float kFixedPointMax = 0x1p20f;

RELUME_HD inline int64_t to_fixed_point(float x) {
  return static_cast<int64_t>(static_cast<double>(clamp(x, -kFixedPointMax, kFixedPointMax)) * 0x1p24);
}
RELUME_HD inline float from_fixed_point(int64_t x) { return static_cast<float>(static_cast<double>(x) * 0x1p-24); }

/// RGB sum with order-independent additions.
struct FixedPointRgb {
  int64_t r = 0;
  int64_t g = 0;
  int64_t b = 0;

  /// Thread-safe. `value` must be finite.
  RELUME_HD void add(const Rgb& value) {
    atomic_add(&r, to_fixed_point(value.r));
    atomic_add(&g, to_fixed_point(value.g));
    atomic_add(&b, to_fixed_point(value.b));
  }
  RELUME_HD Rgb value() const { return {from_fixed_point(r), from_fixed_point(g), from_fixed_point(b)}; }
};

}  // namespace relume
