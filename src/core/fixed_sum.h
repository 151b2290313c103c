// Sums of real values as wide integers. Addition of integers is associative, so a sum does not depend on the order of
// its summands, nor on how they are divided into partial sums.
#pragma once

#include <bit>
#include <cstdint>

#include "core/hd.h"

namespace relume {

/// A sum in units of 2^-`fraction_bits`, as a two's complement integer of `words` 64-bit words. Each summand is rounded
/// once to the nearest unit, and limited to ±max(), so that 2^23 summands cannot overflow.
template <int words, int fraction_bits>
struct FixedSum {
  static_assert(words >= 1 && fraction_bits > 0 && fraction_bits < 500);
  static constexpr int kCapacityBits = 23;

  uint64_t word[words] = {};  ///< the least significant first

  /// Largest absolute value of a summand.
  RELUME_HD static constexpr double max() { return power_of_two(64 * words - 1 - kCapacityBits - fraction_bits); }

  /// Adds a finite value.
  RELUME_HD void add(double value) {
    const double limited = value < -max() ? -max() : value > max() ? max() : value;
    const auto bits = std::bit_cast<uint64_t>(limited);
    const int exponent = static_cast<int>((bits >> 52) & 0x7ffu);
    int shift = exponent - 1075 + fraction_bits;  // |value| = mantissa · 2^shift units
    if (exponent == 0 || shift < -53) return;     // less than half a unit
    uint64_t mantissa = (bits & ((uint64_t{1} << 52) - 1)) | (uint64_t{1} << 52);
    if (shift < 0) {
      mantissa = (mantissa + (uint64_t{1} << (-shift - 1))) >> -shift;
      shift = 0;
    }
    const FixedSum magnitude = shifted(mantissa, shift);
    add((bits >> 63) != 0 ? magnitude.negated() : magnitude);
  }

  RELUME_HD void add(const FixedSum& other) {
    uint64_t carry = 0;
    for (int i = 0; i < words; ++i) {
      const uint64_t partial = word[i] + other.word[i];
      const uint64_t total = partial + carry;
      carry = (partial < word[i] || total < partial) ? 1 : 0;
      word[i] = total;
    }
  }

  /// The sum, rounded to a double.
  RELUME_HD double value() const {
    const bool is_negative = (word[words - 1] >> 63) != 0;
    const FixedSum magnitude = is_negative ? negated() : *this;
    double sum = 0;
    for (int i = words - 1; i >= 0; --i) sum = sum * 0x1p64 + static_cast<double>(magnitude.word[i]);
    sum *= power_of_two(-fraction_bits);
    return is_negative ? -sum : sum;
  }

  friend RELUME_HD bool operator==(const FixedSum& a, const FixedSum& b) {
    for (int i = 0; i < words; ++i) {
      if (a.word[i] != b.word[i]) return false;
    }
    return true;
  }

 private:
  RELUME_HD static constexpr double power_of_two(int exponent) {
    return std::bit_cast<double>(static_cast<uint64_t>(exponent + 1023) << 52);
  }
  /// `mantissa` · 2^`shift`, without an index that is known only at run time: kernels would need a stack for it.
  RELUME_HD static FixedSum shifted(uint64_t mantissa, int shift) {
    const int at = shift / 64;
    const int bits = shift % 64;
    FixedSum sum;
    for (int i = 0; i < words; ++i) {
      if (i == at) sum.word[i] = mantissa << bits;
      if (i == at + 1 && bits > 0) sum.word[i] = mantissa >> (64 - bits);
    }
    return sum;
  }
  RELUME_HD FixedSum negated() const {
    FixedSum sum;
    uint64_t carry = 1;
    for (int i = 0; i < words; ++i) {
      sum.word[i] = ~word[i] + carry;
      carry = (carry != 0 && sum.word[i] == 0) ? 1 : 0;
    }
    return sum;
  }
};

}  // namespace relume
