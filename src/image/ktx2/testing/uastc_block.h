// UASTC blocks for tests: a writer, and the texels by the rules of ASTC, of which UASTC is a subset. Both are
// independent of the decoder: they use tables where it computes, and compute where it uses tables.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image/ktx2/testing/bit_writer.h"
#include "image/ktx2/uastc.h"

namespace relume::testing {

/// A block in one of the modes 0 to 18, with its stored numbers.
struct UastcBlock {
  /// Digit and bits of an endpoint's channel.
  struct Value {
    uint32_t digit = 0;  ///< trit or quint, in modes with digits
    uint32_t bits = 0;
  };

  int mode = 0;
  std::array<uint8_t, 4> solid{};                     ///< mode 8
  uint32_t pattern = 0;                               ///< modes 2, 3, 4, 7, 9, 16
  uint32_t selector = 0;                              ///< channel of the second plane, modes 6, 11 and 13
  std::vector<Value> endpoints;                       ///< low and high endpoint of each subset and channel
  std::array<std::array<uint32_t, 2>, 16> weights{};  ///< by texel and plane
  uint32_t hints = 0;                                 ///< pattern repeated over all hint bits
};

/// Number of values in UastcBlock::endpoints, their bits, and the base of their digits (1: none).
struct UastcEndpointLayout {
  size_t count;
  uint32_t bits;
  uint32_t base;
};
UastcEndpointLayout uastc_endpoint_layout(int mode);

/// Bits per weight.
uint32_t uastc_weight_bits(int mode);
/// Number of planes of weights.
size_t uastc_planes(int mode);
/// Number of partition patterns; 0: one subset.
uint32_t uastc_patterns(int mode);

/// Subset of each texel, by ASTC's partition function.
std::array<int, 16> astc_partition(int mode, uint32_t pattern);

/// Encodes the block. Anchor weights lose their highest bit.
std::vector<std::byte> write_uastc_block(const UastcBlock& block);

/// Texels by the rules of ASTC.
detail::UastcTexels astc_texels(const UastcBlock& block, bool srgb);

}  // namespace relume::testing
