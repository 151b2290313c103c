// A field of up to 128 bits with the operations of a compressed tree: rank, select, and insertion and removal of four
// zeros. Rank and select are those of [Jacobson89]; for so few bits they need no tables.
#pragma once

#include <bit>
#include <cstdint>

#include "core/hd.h"

namespace relume {

/// Bits 0 … 127 in words of 32 bits, so that narrower fields take fewer words.
struct BitField {
  static constexpr uint32_t kWords = 4;

  uint32_t words[kWords];

  RELUME_HD bool get(uint32_t i) const { return (words[i >> 5] >> (i & 31u)) & 1u; }
  RELUME_HD void set(uint32_t i) { words[i >> 5] |= 1u << (i & 31u); }
  RELUME_HD void clear(uint32_t i) { words[i >> 5] &= ~(1u << (i & 31u)); }
  /// The four bits from 4·group.
  RELUME_HD uint32_t nibble(uint32_t group) const { return (words[group >> 3] >> ((group & 7u) * 4)) & 15u; }

  /// Number of ones among bits [0, i).
  RELUME_HD uint32_t rank(uint32_t i) const {
    uint32_t ones = 0;
    const uint32_t full = i >> 5;
    for (uint32_t w = 0; w < full; ++w) ones += popcount(words[w]);
    const uint32_t rest = i & 31u;
    return rest == 0 ? ones : ones + popcount(words[full] & ((1u << rest) - 1u));
  }

  /// Index of the k-th (from 0) bit that equals `value`, which must exist.
  RELUME_HD uint32_t select(uint32_t k, bool value) const {
    uint32_t w = 0;
    for (; w < kWords - 1; ++w) {
      const uint32_t count = popcount(value ? words[w] : ~words[w]);
      if (k < count) break;
      k -= count;
    }
    uint32_t bits = value ? words[w] : ~words[w];
    uint32_t base = 0;
    for (uint32_t width = 16; width > 0; width >>= 1) {  // halves the range that contains the bit
      const uint32_t count = popcount(bits & ((1u << width) - 1u));
      if (k >= count) {
        k -= count;
        base += width;
        bits >>= width;
      }
    }
    return w * 32 + base;
  }

  /// Removes bits 4·group … 4·group + 3. Higher bits move down, and zeros enter at the top.
  RELUME_HD void remove_nibble(uint32_t group) {
    const uint32_t w = group >> 3;
    const uint32_t below = low_mask(group);
    for (uint32_t i = w; i < kWords; ++i) {
      const uint32_t incoming = i + 1 < kWords ? words[i + 1] << 28 : 0u;
      const uint32_t shifted = (words[i] >> 4) | incoming;
      words[i] = i == w ? (words[i] & below) | (shifted & ~below) : shifted;
    }
  }

  /// Inserts four zeros at 4·group. Higher bits move up, and the top four are lost.
  RELUME_HD void insert_nibble(uint32_t group) {
    const uint32_t w = group >> 3;
    const uint32_t below = low_mask(group);
    for (uint32_t i = kWords - 1; i > w; --i) words[i] = (words[i] << 4) | (words[i - 1] >> 28);
    words[w] = (words[w] & below) | ((words[w] & ~below) << 4);
  }

 private:
  RELUME_HD static uint32_t popcount(uint32_t x) { return static_cast<uint32_t>(std::popcount(x)); }
  RELUME_HD static uint32_t low_mask(uint32_t group) { return (1u << ((group & 7u) * 4)) - 1u; }
};

}  // namespace relume
