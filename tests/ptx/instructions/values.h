// Registers, their values, and what all instructions share. A register holds bits: integers are unsigned in C++, and
// an instruction reads them as its own type.
#pragma once

#include <bit>
#include <cfloat>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

namespace ptx {

static_assert(FLT_EVAL_METHOD == 0, "operations round to their own type");

/// Unsigned integer of the same size.
template <typename T>
using Bits = std::conditional_t<
    sizeof(T) == 1, uint8_t,
    std::conditional_t<sizeof(T) == 2, uint16_t, std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>>>;

template <typename T>
inline constexpr uint32_t kWidth = 8 * sizeof(T);

/// The value of a register as a type of the instruction: the same bits, or the low ones of a wider register.
template <typename T, typename Register>
T get(Register r) {
  if constexpr (std::is_same_v<T, Register>) {
    return r;
  } else if constexpr (sizeof(T) == sizeof(Register)) {
    return std::bit_cast<T>(r);
  } else {
    static_assert(std::is_integral_v<T> && std::is_integral_v<Register> && sizeof(T) < sizeof(Register));
    return static_cast<T>(r);
  }
}

/// The address of a variable.
template <typename T>
T get(unsigned char* address) {
  return static_cast<T>(reinterpret_cast<uintptr_t>(address));
}

/// Writes a register. A wider one extends the value: signed types with their sign, others with zeros.
template <typename Register, typename T>
void set(Register& r, T value) {
  if constexpr (sizeof(T) == sizeof(Register)) {
    r = std::bit_cast<Register>(value);
  } else {
    static_assert(std::is_integral_v<T> && std::is_integral_v<Register> && sizeof(T) < sizeof(Register));
    r = static_cast<Register>(value);
  }
}

/// A floating-point constant.
template <typename T, typename B>
T from_bits(B bits) {
  return std::bit_cast<T>(static_cast<Bits<T>>(bits));
}

/// The NaN that instructions return. For f32 the ISA demands it. For f64 it demands none; this one is CUDA's constant.
template <typename T>
T not_a_number() {
  if constexpr (sizeof(T) == 4) {
    return std::bit_cast<T>(0x7fffffffu);
  } else {
    return std::bit_cast<T>(uint64_t{0xfff8000000000000});
  }
}

template <typename T>
bool is_nan(T x) {
  return x != x;
}

/// `x`, or the NaN of the ISA.
template <typename T>
T canonical(T x) {
  return is_nan(x) ? not_a_number<T>() : x;
}

/// Bits of a packed value, in order from the lowest.
template <typename Packed, typename... T>
Packed pack(T... values) {
  static_assert(sizeof(Packed) == (sizeof(T) + ...));
  Packed packed = 0;
  uint32_t at = 0;
  ((packed = static_cast<Packed>(packed | static_cast<Packed>(static_cast<Packed>(values) << at)), at += kWidth<T>),
   ...);
  return packed;
}

/// Element `index` of a packed value.
template <typename T, uint32_t index, typename Packed>
T part(Packed packed) {
  return static_cast<T>(packed >> (index * kWidth<T>));
}

}  // namespace ptx
