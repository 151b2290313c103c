// Loads, stores and atomic operations (PTX ISA 9.7.9 and 9.7.13). All state spaces are memory of the processor.
#pragma once

#include "instructions/values.h"

namespace ptx {

/// Throws Fault.
[[noreturn]] void fail_alignment(const void* address, size_t alignment);

inline unsigned char* pointer(uint64_t base, int64_t offset) {
  return reinterpret_cast<unsigned char*>(base + static_cast<uint64_t>(offset));
}

/// The address. An access that is not naturally aligned is a Fault, as on a device.
template <size_t alignment>
unsigned char* aligned(unsigned char* address) {
  if (reinterpret_cast<uintptr_t>(address) % alignment != 0) [[unlikely]]
    fail_alignment(address, alignment);
  return address;
}

template <typename T>
T load(const unsigned char* at, uint32_t index) {
  T value;
  std::memcpy(&value, at + index * sizeof(T), sizeof(T));
  return value;
}

template <typename T>
void store(unsigned char* at, uint32_t index, T value) {
  std::memcpy(at + index * sizeof(T), &value, sizeof(T));
}

template <typename T>
T load_volatile(const unsigned char* at, uint32_t index) {
  return std::bit_cast<T>(reinterpret_cast<const volatile Bits<T>*>(at)[index]);
}

template <typename T>
void store_volatile(unsigned char* at, uint32_t index, T value) {
  reinterpret_cast<volatile Bits<T>*>(at)[index] = std::bit_cast<Bits<T>>(value);
}

inline void fence() { __atomic_thread_fence(__ATOMIC_SEQ_CST); }

// ---- Atomic operations, relaxed. All return the old value.

template <typename T, typename Change>
T replace(unsigned char* at, Change change) {
  auto* const word = reinterpret_cast<T*>(at);
  T old = __atomic_load_n(word, __ATOMIC_RELAXED);
  while (
      !__atomic_compare_exchange_n(word, &old, static_cast<T>(change(old)), true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
  return old;
}

template <typename T>
T atom_add(unsigned char* at, T value) {
  return __atomic_fetch_add(reinterpret_cast<T*>(at), value, __ATOMIC_RELAXED);
}

template <typename T>
T atom_and(unsigned char* at, T value) {
  return __atomic_fetch_and(reinterpret_cast<T*>(at), value, __ATOMIC_RELAXED);
}

template <typename T>
T atom_or(unsigned char* at, T value) {
  return __atomic_fetch_or(reinterpret_cast<T*>(at), value, __ATOMIC_RELAXED);
}

template <typename T>
T atom_xor(unsigned char* at, T value) {
  return __atomic_fetch_xor(reinterpret_cast<T*>(at), value, __ATOMIC_RELAXED);
}

template <typename T>
T atom_exch(unsigned char* at, T value) {
  return __atomic_exchange_n(reinterpret_cast<T*>(at), value, __ATOMIC_RELAXED);
}

template <typename T>
T atom_min(unsigned char* at, T value) {
  return replace<T>(at, [value](T old) { return value < old ? value : old; });
}

template <typename T>
T atom_max(unsigned char* at, T value) {
  return replace<T>(at, [value](T old) { return value > old ? value : old; });
}

/// Counts up to `last`, then begins at 0.
template <typename T>
T atom_inc(unsigned char* at, T last) {
  return replace<T>(at, [last](T old) { return old >= last ? T{0} : old + 1; });
}

/// Counts down to 0, then begins at `last`.
template <typename T>
T atom_dec(unsigned char* at, T last) {
  return replace<T>(at, [last](T old) { return old == 0 || old > last ? last : old - 1; });
}

/// Stores `desired` if the word equals `expected`.
template <typename T>
T atom_cas(unsigned char* at, T expected, T desired) {
  __atomic_compare_exchange_n(reinterpret_cast<T*>(at), &expected, desired, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
  return expected;
}

}  // namespace ptx
