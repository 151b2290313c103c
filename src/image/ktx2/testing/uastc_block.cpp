#include "image/ktx2/testing/uastc_block.h"

#include <algorithm>
#include <set>
#include <span>
#include <string_view>

namespace relume::testing {
namespace {

// Khronos Data Format Specification 1.4, §"Unquantizing endpoints": values of digit · 2^bits + bits for each range.
constexpr uint8_t kTo11[] = {0, 255, 69, 186, 23, 232, 92, 163, 46, 209, 116, 139};
constexpr uint8_t kTo39[] = {0,   255, 32,  223, 65, 190, 97, 158, 6,   249, 39,  216, 71, 184,
                             104, 151, 13,  242, 45, 210, 78, 177, 110, 145, 19,  236, 52, 203,
                             84,  171, 117, 138, 26, 229, 58, 197, 91,  164, 123, 132};
constexpr uint8_t kTo47[] = {0,  255, 16, 239, 32, 223, 48, 207, 65, 190, 81, 174, 97,  158, 113, 142,
                             5,  250, 21, 234, 38, 217, 54, 201, 70, 185, 86, 169, 103, 152, 119, 136,
                             11, 244, 27, 228, 43, 212, 59, 196, 76, 179, 92, 163, 108, 147, 124, 131};
constexpr uint8_t kTo159[] = {
    0,   255, 8,   247, 16,  239, 24,  231, 32,  223, 40,  215, 48,  207, 56,  199, 64,  191, 72,  183, 80,  175, 88,
    167, 96,  159, 104, 151, 112, 143, 120, 135, 1,   254, 9,   246, 17,  238, 25,  230, 33,  222, 41,  214, 49,  206,
    57,  198, 65,  190, 73,  182, 81,  174, 89,  166, 97,  158, 105, 150, 113, 142, 121, 134, 3,   252, 11,  244, 19,
    236, 27,  228, 35,  220, 43,  212, 51,  204, 59,  196, 67,  188, 75,  180, 83,  172, 91,  164, 99,  156, 107, 148,
    115, 140, 123, 132, 4,   251, 12,  243, 20,  235, 28,  227, 36,  219, 44,  211, 52,  203, 60,  195, 68,  187, 76,
    179, 84,  171, 92,  163, 100, 155, 108, 147, 116, 139, 124, 131, 6,   249, 14,  241, 22,  233, 30,  225, 38,  217,
    46,  209, 54,  201, 62,  193, 70,  185, 78,  177, 86,  169, 94,  161, 102, 153, 110, 145, 118, 137, 126, 129};
constexpr uint8_t kTo191[] = {
    0,  255, 4,   251, 8,   247, 12,  243, 16,  239, 20,  235, 24,  231, 28,  227, 32,  223, 36,  219, 40, 215,
    44, 211, 48,  207, 52,  203, 56,  199, 60,  195, 64,  191, 68,  187, 72,  183, 76,  179, 80,  175, 84, 171,
    88, 167, 92,  163, 96,  159, 100, 155, 104, 151, 108, 147, 112, 143, 116, 139, 120, 135, 124, 131, 1,  254,
    5,  250, 9,   246, 13,  242, 17,  238, 21,  234, 25,  230, 29,  226, 33,  222, 37,  218, 41,  214, 45, 210,
    49, 206, 53,  202, 57,  198, 61,  194, 65,  190, 69,  186, 73,  182, 77,  178, 81,  174, 85,  170, 89, 166,
    93, 162, 97,  158, 101, 154, 105, 150, 109, 146, 113, 142, 117, 138, 121, 134, 125, 130, 2,   253, 6,  249,
    10, 245, 14,  241, 18,  237, 22,  233, 26,  229, 30,  225, 34,  221, 38,  217, 42,  213, 46,  209, 50, 205,
    54, 201, 58,  197, 62,  193, 66,  189, 70,  185, 74,  181, 78,  177, 82,  173, 86,  169, 90,  165, 94, 161,
    98, 157, 102, 153, 106, 149, 110, 145, 114, 141, 118, 137, 122, 133, 126, 129};

/// Rows of table "UASTC to ASTC configuration mapping".
struct AstcConfiguration {
  uint32_t max_weight;
  uint32_t max_endpoint;
  int subsets;
  int endpoint_mode;  ///< CEM 4: luminance and alpha; 8: RGB; 12: RGBA
};
constexpr AstcConfiguration kConfigurations[] = {
    {15, 191, 1, 8}, {3, 255, 1, 8},  {7, 15, 2, 8},  {3, 11, 3, 8},   {3, 39, 2, 8},  {7, 255, 1, 8},  {3, 159, 1, 8},
    {3, 39, 2, 8},   {0, 0, 0, 0},    {3, 15, 2, 12}, {15, 47, 1, 12}, {3, 47, 1, 12}, {7, 191, 1, 12}, {1, 255, 1, 12},
    {3, 255, 1, 12}, {15, 255, 1, 4}, {3, 255, 2, 4}, {3, 255, 1, 4},  {31, 31, 1, 8}};

// Tables "ASTC Partition Index for UASTC PAT values" of the same specification.
constexpr int kSeeds2[] = {28, 20,  16,  29, 91,  9,   107, 72,  149, 204, 50,  114, 496, 17,  78,
                           39, 252, 828, 43, 156, 116, 210, 476, 273, 684, 359, 246, 195, 694, 524};
constexpr int kSeeds3[] = {260, 74, 32, 156, 183, 15, 745, 0, 335, 902, 254};
constexpr int kSeeds7[] = {36, 48, 61, 137, 161, 183, 226, 281, 302, 307, 479, 495, 593, 594, 605, 799, 812, 988, 993};

bool is_one_of(int mode, const std::set<int>& modes) { return modes.count(mode) > 0; }

std::span<const int> seeds(int mode) {
  if (mode == 3) return kSeeds3;
  if (mode == 7) return kSeeds7;
  if (is_one_of(mode, {2, 4, 9, 16})) return kSeeds2;
  return {};
}

/// ASTC's hash52().
uint32_t hash(uint32_t p) {
  p ^= p >> 15;
  p -= p << 17;
  p += p << 7;
  p += p << 4;
  p ^= p >> 5;
  p += p << 16;
  p ^= p >> 7;
  p ^= p >> 3;
  p ^= p << 6;
  p ^= p >> 17;
  return p;
}

/// ASTC's select_partition() for blocks of 4 × 4 texels and 2 or 3 partitions.
int select_partition(int seed, int x, int y, int partitions) {
  seed += (partitions - 1) * 1024;
  const uint32_t random = hash(static_cast<uint32_t>(seed));
  const int odd_shift = (seed & 2) != 0 ? 4 : 5;
  const int other_shift = partitions == 3 ? 6 : 5;
  const int shift_x = (seed & 1) != 0 ? odd_shift : other_shift;
  const int shift_y = (seed & 1) != 0 ? other_shift : odd_shift;
  const auto factor = [&](int nibble, int shift) {
    const auto n = static_cast<int>(random >> (4 * nibble) & 15u);
    return n * n >> shift;
  };
  const auto value = [&](int nibble, int offset) {
    return (factor(nibble, shift_x) * 2 * x + factor(nibble + 1, shift_y) * 2 * y +
            static_cast<int>(random >> offset & 63u)) &
           63;
  };
  const int a = value(0, 14);
  const int b = value(2, 10);
  const int c = partitions == 3 ? value(4, 6) : 0;
  if (a >= b && a >= c) return 0;
  return b >= c ? 1 : 2;
}

int unquantize(int mode, const UastcBlock::Value& value) {
  const UastcEndpointLayout layout = uastc_endpoint_layout(mode);
  const uint32_t index = value.digit << layout.bits | value.bits;
  switch (kConfigurations[mode].max_endpoint) {
    case 11: return kTo11[index];
    case 15: return static_cast<int>(index) * 17;
    case 31: return static_cast<int>(index << 3 | index >> 2);
    case 39: return kTo39[index];
    case 47: return kTo47[index];
    case 159: return kTo159[index];
    case 191: return kTo191[index];
    default: return static_cast<int>(index);
  }
}

/// Table "UASTC unquantization values for weight expansion".
int unquantize_weight(int mode, uint32_t weight) {
  constexpr int k4[] = {0, 21, 43, 64};
  constexpr int k8[] = {0, 9, 18, 27, 37, 46, 55, 64};
  constexpr int k16[] = {0, 4, 8, 12, 17, 21, 25, 29, 35, 39, 43, 47, 52, 56, 60, 64};
  switch (kConfigurations[mode].max_weight) {
    case 1: return weight == 0 ? 0 : 64;
    case 3: return k4[weight];
    case 7: return k8[weight];
    case 15: return k16[weight];
    default: return static_cast<int>(weight < 16 ? 2 * weight : 2 * weight + 2);
  }
}

/// Code of a mode as in table "UASTC Mode Index encoding", highest bit first.
const char* mode_code(int mode) {
  constexpr const char* kCodes[] = {"0001",  "110101",  "11101",  "00011",  "10011", "01011", "11011",
                                    "00111", "10111",   "01111",  "010",    "00",    "110",   "11111",
                                    "01101", "0000101", "010101", "100101", "1001"};
  return kCodes[mode];
}

/// Bits of table "Block configuration bits" without the code, the pattern and the channel selector.
size_t hint_bits(int mode) {
  size_t bits = 1 + 1 + 1 + 3 + 3;  // BC1H0, ETC1F, ETC1D, ETCI0, ETCI1
  if (is_one_of(mode, {0, 1, 2, 3, 4, 5, 6, 7, 9, 13, 14, 15, 16, 17, 18})) bits += 1 + 5;  // BC1H1, ETCBI
  if (mode >= 9 && mode <= 17) bits += 8;                                                   // ETC2T, ETC2M
  return bits;
}

/// Writes the digits of all values, the first in the lowest position of each group.
void put_digits(const UastcBlock& block, const UastcEndpointLayout& layout, BitWriter& bits) {
  const size_t group = layout.base == 3 ? 5 : 3;
  for (size_t first = 0; first < layout.count; first += group) {
    const size_t last = std::min(first + group, layout.count);
    uint32_t packed = 0;
    uint32_t values = 1;
    for (size_t i = last; i > first; --i) packed = packed * layout.base + block.endpoints[i - 1].digit;
    for (size_t i = first; i < last; ++i) values *= layout.base;
    size_t count = 0;
    while ((1u << count) < values) ++count;
    bits.put(packed, count);
  }
}

}  // namespace

UastcEndpointLayout uastc_endpoint_layout(int mode) {
  const AstcConfiguration& configuration = kConfigurations[mode];
  const size_t count = static_cast<size_t>(configuration.subsets) * (configuration.endpoint_mode == 4   ? 4
                                                                     : configuration.endpoint_mode == 8 ? 6
                                                                                                        : 8);
  const uint32_t values = configuration.max_endpoint + 1;
  for (const uint32_t base : {3u, 5u, 1u}) {
    uint32_t bits = 0;
    while (base << bits < values) ++bits;
    if (base << bits == values) return {count, bits, base};
  }
  return {};
}

uint32_t uastc_weight_bits(int mode) {
  uint32_t bits = 0;
  while ((1u << bits) <= kConfigurations[mode].max_weight) ++bits;
  return bits;
}

size_t uastc_planes(int mode) { return is_one_of(mode, {6, 11, 13, 17}) ? 2 : 1; }

uint32_t uastc_patterns(int mode) { return static_cast<uint32_t>(seeds(mode).size()); }

std::array<int, 16> astc_partition(int mode, uint32_t pattern) {
  std::array<int, 16> partition{};
  if (seeds(mode).empty()) return partition;
  for (int i = 0; i < 16; ++i)
    partition[static_cast<size_t>(i)] =
        select_partition(seeds(mode)[pattern], i % 4, i / 4, kConfigurations[mode].subsets);
  return partition;
}

std::vector<std::byte> write_uastc_block(const UastcBlock& block) {
  constexpr size_t kBits = 128;
  BitWriter bits;
  const std::string_view code = mode_code(block.mode);
  for (size_t i = code.size(); i > 0; --i) bits.put(code[i - 1] == '1' ? 1 : 0, 1);
  if (block.mode == 8) {
    for (const uint8_t channel : block.solid) bits.put(channel, 8);
    bits.put(0, kBits - bits.used());
    return bits.bytes();
  }
  bits.put(block.hints, hint_bits(block.mode));
  if (uastc_patterns(block.mode) > 0) bits.put(block.pattern, block.mode == 3 ? 4 : 5);
  if (is_one_of(block.mode, {6, 11, 13})) bits.put(block.selector, 2);
  const UastcEndpointLayout layout = uastc_endpoint_layout(block.mode);
  if (layout.base != 1) put_digits(block, layout, bits);
  for (const UastcBlock::Value& value : block.endpoints) bits.put(value.bits, layout.bits);
  std::set<int> anchored;
  const std::array<int, 16> partition = astc_partition(block.mode, block.pattern);
  for (size_t i = 0; i < 16; ++i) {
    const bool is_anchor = anchored.insert(partition[i]).second;
    for (size_t plane = 0; plane < uastc_planes(block.mode); ++plane)
      bits.put(block.weights[i][plane], uastc_weight_bits(block.mode) - (is_anchor ? 1 : 0));
  }
  bits.put(0, kBits - bits.used());
  return bits.bytes();
}

detail::UastcTexels astc_texels(const UastcBlock& block, bool srgb) {
  detail::UastcTexels texels{};
  if (block.mode == 8) {
    texels.fill(block.solid);
    return texels;
  }
  const size_t channels = kConfigurations[block.mode].endpoint_mode == 4   ? 2
                          : kConfigurations[block.mode].endpoint_mode == 8 ? 3
                                                                           : 4;
  const size_t second_plane = uastc_planes(block.mode) == 1 ? 4 : block.mode == 17 ? 3 : block.selector;
  const std::array<int, 16> partition = astc_partition(block.mode, block.pattern);
  for (size_t i = 0; i < 16; ++i) {
    for (size_t c = 0; c < 4; ++c) {
      const size_t source = channels == 2 ? c / 3 : c;
      int low = 255;
      int high = 255;
      if (source < channels) {
        const size_t first = 2 * (static_cast<size_t>(partition[i]) * channels + source);
        low = unquantize(block.mode, block.endpoints[first]);
        high = unquantize(block.mode, block.endpoints[first + 1]);
      }
      const int weight = unquantize_weight(block.mode, block.weights[i][c == second_plane ? 1 : 0]);
      low = low * 256 + (srgb ? 128 : low);
      high = high * 256 + (srgb ? 128 : high);
      texels[i][c] = static_cast<uint8_t>((low * (64 - weight) + high * weight + 32) / 64 / 256);
    }
  }
  return texels;
}

}  // namespace relume::testing
