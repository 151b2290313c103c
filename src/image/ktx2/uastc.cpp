// Khronos Data Format Specification 1.4, chapter "Universal ASTC Compressed Texture Images".
#include "image/ktx2/uastc.h"

#include <algorithm>
#include <optional>

#include "files/little_endian.h"
#include "image/ktx2/uastc_tables.h"

namespace relume::detail {
namespace {

constexpr std::array<uint8_t, 4> kErrorColor = {255, 0, 255, 255};
constexpr size_t kMaxEndpointValues = 18;  ///< mode 3: 3 subsets · 3 channels · 2

/// Reads the bits of a block, starting at the lowest. No mode needs more bits than a block has.
class BlockBits {
 public:
  explicit BlockBits(std::span<const std::byte, kUastcBlockBytes> block)
      : low_(number_at(block, 0, 8)), high_(number_at(block, 8, 8)) {}

  uint32_t peek(size_t count) const { return static_cast<uint32_t>(low_ & ((uint64_t{1} << count) - 1)); }

  void skip(size_t count) {
    if (count == 0) return;
    low_ = low_ >> count | high_ << (64 - count);
    high_ >>= count;
  }

  uint32_t read(size_t count) {
    const uint32_t bits = peek(count);
    skip(count);
    return bits;
  }

 private:
  uint64_t low_;
  uint64_t high_;
};

/// Mode index by the lowest 7 bits of a block; kUastcModes: none.
constexpr std::array<uint8_t, 128> make_mode_of_bits() {
  std::array<uint8_t, 128> result{};
  for (size_t bits = 0; bits < result.size(); ++bits) {
    result[bits] = kUastcModes;
    for (size_t mode = 0; mode < kUastcModes; ++mode) {
      const UastcMode& m = kUastcModeTable[mode];
      if ((bits & ((1u << m.code_bits) - 1)) == m.code) result[bits] = static_cast<uint8_t>(mode);
    }
  }
  return result;
}
constexpr std::array<uint8_t, 128> kModeOfBits = make_mode_of_bits();

/// Subset of each texel.
struct Partition {
  uint32_t subsets = 0;
  uint32_t bits = 0;  ///< per texel; 0: all texels are in subset 0

  uint32_t subset(size_t texel) const { return subsets >> (bits * texel) & ((1u << bits) - 1); }
};

/// Returns std::nullopt for invalid patterns.
std::optional<Partition> find_partition(size_t mode, uint32_t pattern) {
  constexpr size_t kThreeSubsets = 3;
  constexpr size_t kOtherPatterns = 7;
  if (kUastcModeTable[mode].pattern_bits == 0) return Partition{};
  if (mode == kThreeSubsets)
    return pattern < kUastcPatterns3.size() ? std::optional(Partition{kUastcPatterns3[pattern], 2}) : std::nullopt;
  if (mode == kOtherPatterns)
    return pattern < kUastcPatterns7.size() ? std::optional(Partition{kUastcPatterns7[pattern], 1}) : std::nullopt;
  return pattern < kUastcPatterns2.size() ? std::optional(Partition{kUastcPatterns2[pattern], 1}) : std::nullopt;
}

/// Expands an endpoint channel of `bits` bits without a digit to 8 bits.
uint8_t unquantize_bits(uint32_t value, uint32_t bits) {
  return static_cast<uint8_t>(value << (8 - bits) | value >> (2 * bits - 8));
}

/// Expands an endpoint channel with a digit to 8 bits (Khronos Data Format Specification, table "ASTC color
/// unquantization parameters"). `value` contains its bits.
uint8_t unquantize_digit(uint32_t value, uint32_t digit, const UastcMode& mode) {
  const uint32_t high = value >> 1;
  uint32_t spread = 0;  // B in the specification
  uint32_t scale = 0;   // C
  switch (mode.endpoint_bits) {
    case 2:
      spread = high * 0x116;
      scale = 93;
      break;
    case 3:
      spread = high << 7 | high << 1 | high >> 1;
      scale = 26;
      break;
    case 4:
      spread = high << 6 | high;
      scale = 22;
      break;
    case 5:
      spread = high << 5 | high >> 3;
      scale = 6;
      break;
    default:
      spread = high << 4 | high >> 4;
      scale = 5;
      break;
  }
  const uint32_t inverted = (value & 1u) != 0 ? 0x1ff : 0;  // A
  const uint32_t result = (digit * scale + spread) ^ inverted;
  return static_cast<uint8_t>((inverted & 0x80) | result >> 2);
}

using EndpointValues = std::array<uint8_t, kMaxEndpointValues>;

/// Reads the digits of all values, packed in groups of up to 5 trits or 3 quints.
EndpointValues read_digits(const UastcMode& mode, size_t count, BlockBits& bits) {
  constexpr std::array<uint8_t, 6> kTritBits = {0, 2, 4, 5, 7, 8};  // indexed by the number of trits
  constexpr std::array<uint8_t, 4> kQuintBits = {0, 3, 5, 7};
  EndpointValues digits{};
  if (mode.digit_base == 1) return digits;
  const size_t group = mode.digit_base == 3 ? 5 : 3;
  for (size_t first = 0; first < count; first += group) {
    const size_t size = std::min(group, count - first);
    uint32_t packed = bits.read(mode.digit_base == 3 ? kTritBits[size] : kQuintBits[size]);
    for (size_t i = 0; i < size; ++i, packed /= mode.digit_base)
      digits[first + i] = static_cast<uint8_t>(packed % mode.digit_base);
  }
  return digits;
}

/// Reads 8-bit values in block order: low and high endpoint of each subset and channel.
EndpointValues read_endpoints(const UastcMode& mode, BlockBits& bits) {
  const size_t count = size_t{2} * mode.subsets * mode.channels;
  EndpointValues values = read_digits(mode, count, bits);
  for (size_t i = 0; i < count; ++i) {
    const uint32_t value = bits.read(mode.endpoint_bits);
    values[i] =
        mode.digit_base == 1 ? unquantize_bits(value, mode.endpoint_bits) : unquantize_digit(value, values[i], mode);
  }
  return values;
}

using Weights = std::array<std::array<uint32_t, 2>, 16>;

/// Reads weights from 0 to 64 per texel and plane. The weight of a subset's first texel lacks its highest bit.
Weights read_weights(const UastcMode& mode, const Partition& partition, BlockBits& bits) {
  const size_t planes = mode.planes == UastcPlanes::one ? 1 : 2;
  uint32_t seen = 0;  // one bit per subset
  Weights weights{};
  for (size_t i = 0; i < weights.size(); ++i) {
    const uint32_t subset = 1u << partition.subset(i);
    const uint32_t missing_bits = (seen & subset) == 0 ? 1 : 0;
    seen |= subset;
    for (size_t plane = 0; plane < planes; ++plane) {
      const uint32_t weight = bits.read(mode.weight_bits - missing_bits);
      uint32_t in_6_bits = 0;
      for (int shift = 6 - mode.weight_bits; shift > -int{mode.weight_bits}; shift -= mode.weight_bits)
        in_6_bits |= shift >= 0 ? weight << shift : weight >> -shift;
      weights[i][plane] = in_6_bits + (in_6_bits > 32 ? 1 : 0);
    }
  }
  return weights;
}

/// ASTC's decode mode decode_unorm8.
uint8_t interpolate(uint32_t low, uint32_t high, uint32_t weight, bool srgb) {
  const uint32_t low_16 = low << 8 | (srgb ? 0x80 : low);
  const uint32_t high_16 = high << 8 | (srgb ? 0x80 : high);
  return static_cast<uint8_t>((low_16 * (64 - weight) + high_16 * weight + 32) >> 14);
}

/// Index of a texel channel among the endpoint channels.
size_t endpoint_channel(const UastcMode& mode, size_t channel) {
  if (mode.channels == 2) return channel == 3 ? 1 : 0;
  return channel;
}

UastcTexels filled_with(const std::array<uint8_t, 4>& color) {
  UastcTexels texels;
  texels.fill(color);
  return texels;
}

UastcTexels decode_solid(BlockBits& bits) {
  std::array<uint8_t, 4> color;
  for (uint8_t& channel : color) channel = static_cast<uint8_t>(bits.read(8));
  return filled_with(color);
}

}  // namespace

UastcTexels decode_uastc_block(std::span<const std::byte, kUastcBlockBytes> block, bool srgb) {
  constexpr size_t kAlpha = 3;
  BlockBits bits(block);
  const size_t mode_index = kModeOfBits[bits.peek(7)];
  if (mode_index == kUastcModes) return filled_with(kErrorColor);
  const UastcMode& mode = kUastcModeTable[mode_index];
  bits.skip(mode.code_bits);
  if (mode_index == kUastcSolidMode) return decode_solid(bits);
  bits.skip(mode.hint_bits);
  const std::optional<Partition> partition = find_partition(mode_index, bits.read(mode.pattern_bits));
  if (!partition) return filled_with(kErrorColor);
  const size_t second_plane = mode.planes == UastcPlanes::selected ? bits.read(2) : kAlpha;
  const EndpointValues endpoints = read_endpoints(mode, bits);
  const Weights weights = read_weights(mode, *partition, bits);
  UastcTexels texels = filled_with({0, 0, 0, 255});
  for (size_t i = 0; i < texels.size(); ++i) {
    for (size_t c = 0; c < 4; ++c) {
      if (c == kAlpha && mode.channels == 3) continue;
      const size_t plane = mode.planes != UastcPlanes::one && c == second_plane ? 1 : 0;
      const uint8_t* pair = &endpoints[2 * (partition->subset(i) * mode.channels + endpoint_channel(mode, c))];
      texels[i][c] = interpolate(pair[0], pair[1], weights[i][plane], srgb);
    }
  }
  return texels;
}

std::vector<uint8_t> decode_uastc(std::span<const std::byte> blocks, size_t width, size_t height, bool srgb) {
  std::vector<uint8_t> rgba(4 * width * height);
  const std::byte* block = blocks.data();
  for (size_t top = 0; top < height; top += 4) {
    for (size_t left = 0; left < width; left += 4) {
      const UastcTexels texels = decode_uastc_block(std::span<const std::byte, kUastcBlockBytes>(block, 16), srgb);
      block += kUastcBlockBytes;
      for (size_t y = 0; y < std::min<size_t>(4, height - top); ++y) {
        for (size_t x = 0; x < std::min<size_t>(4, width - left); ++x)
          std::copy_n(texels[4 * y + x].begin(), 4, &rgba[4 * ((top + y) * width + left + x)]);
      }
    }
  }
  return rgba;
}

}  // namespace relume::detail
