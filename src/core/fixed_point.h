// Sums that do not depend on the order of the summands. Real values are rounded once to 64-bit integers, which are
// added atomically.
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

/// Adds to a shared word and returns its previous value.
template <typename Integer>
RELUME_HD inline Integer atomic_fetch_add(Integer* target, Integer value) {
#if RELUME_DEVICE_CODE
  if constexpr (sizeof(Integer) == 8) {
    return atomicAdd(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
  } else {
    return atomicAdd(reinterpret_cast<unsigned int*>(target), static_cast<unsigned int>(value));
  }
#else
  return std::atomic_ref<Integer>(*target).fetch_add(value, std::memory_order_relaxed);
#endif
}

/// Sets the bits of `value` in a shared word.
RELUME_HD inline void atomic_or(uint64_t* target, uint64_t value) {
#if RELUME_DEVICE_CODE
  atomicOr(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<uint64_t>(*target).fetch_or(value, std::memory_order_relaxed);
#endif
}

/// Reads a word that other threads may be writing.
RELUME_HD inline uint64_t atomic_load(const uint64_t* source) {
#if RELUME_DEVICE_CODE
  return *reinterpret_cast<const volatile uint64_t*>(source);
#else
  return std::atomic_ref<uint64_t>(*const_cast<uint64_t*>(source)).load(std::memory_order_relaxed);
#endif
}

/// Prefetches memory that will be read or written soon. Affects timing only.
RELUME_HD inline void prefetch([[maybe_unused]] const void* address) {
#if !RELUME_DEVICE_CODE
  __builtin_prefetch(address);
#endif
}

/// Stores `desired` if the word equals `expected`; returns the previous value.
RELUME_HD inline uint64_t atomic_compare_exchange(uint64_t* target, uint64_t expected, uint64_t desired) {
#if RELUME_DEVICE_CODE
  return atomicCAS(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(expected),
                   static_cast<unsigned long long>(desired));
#else
  std::atomic_ref<uint64_t>(*target).compare_exchange_strong(expected, desired, std::memory_order_relaxed);
  return expected;
#endif
}
RELUME_HD inline uint32_t atomic_compare_exchange(uint32_t* target, uint32_t expected, uint32_t desired) {
#if RELUME_DEVICE_CODE
  return atomicCAS(target, expected, desired);
#else
  std::atomic_ref<uint32_t>(*target).compare_exchange_strong(expected, desired, std::memory_order_relaxed);
  return expected;
#endif
}

/// Replaces a shared word with `value` if that is smaller.
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

/// Replaces a shared word with `value` if that is larger.
RELUME_HD inline void atomic_max(uint64_t* target, uint64_t value) {
#if RELUME_DEVICE_CODE
  atomicMax(reinterpret_cast<unsigned long long*>(target), static_cast<unsigned long long>(value));
#else
  std::atomic_ref<uint64_t> shared(*target);
  uint64_t seen = shared.load(std::memory_order_relaxed);
  while (value > seen && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}
RELUME_HD inline void atomic_max(uint32_t* target, uint32_t value) {
#if RELUME_DEVICE_CODE
  atomicMax(target, value);
#else
  std::atomic_ref<uint32_t> shared(*target);
  uint32_t seen = shared.load(std::memory_order_relaxed);
  while (value > seen && !shared.compare_exchange_weak(seen, value, std::memory_order_relaxed)) {
  }
#endif
}

/// Value of one unit of the fixed-point sums of radiance: 2^-24. Sums must stay below 2^39.
inline constexpr float kFixedPointUnit = 0x1p-24f;
/// Limit at which summands are clamped, so that fewer than 2^19 of them cannot overflow. Callers count clamped ones as
/// saturated.
inline constexpr float kFixedPointMax = 0x1p20f;

/// Nearest number of units; ties round to even, the default of hosts and devices.
RELUME_HD inline int64_t to_fixed_point(float x) {
  return std::llrint(static_cast<double>(clamp(x, -kFixedPointMax, kFixedPointMax)) * 0x1p24);
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
