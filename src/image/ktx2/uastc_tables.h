// Layouts of UASTC blocks and their partition patterns: tables from the Khronos Data Format Specification 1.4, chapter
// "Universal ASTC Compressed Texture Images".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace relume::detail {

/// Channels with a separate plane of weights.
enum class UastcPlanes : uint8_t {
  one,       ///< nothing
  selected,  ///< the channel selected by 2 bits of the block
  alpha,     ///< alpha
};

/// Fields of a block in bit order: code, hints, pattern, channel of the second plane, endpoints, weights.
struct UastcMode {
  uint8_t code;           ///< lowest bit first
  uint8_t code_bits;      ///< 2 to 7
  uint8_t hint_bits;      ///< hints for transcoders, skipped by decoders
  uint8_t pattern_bits;   ///< 0: one subset
  uint8_t subsets;        ///< pairs of endpoints
  UastcPlanes planes;     ///< of weights
  uint8_t channels;       ///< 2: luminance and alpha; 3: RGB; 4: RGBA
  uint8_t weight_bits;    ///< bits per weight
  uint8_t endpoint_bits;  ///< bits per endpoint channel, without its digit
  uint8_t digit_base;     ///< base of an additional digit per endpoint channel, 3 or 5; 1: no digit
};

inline constexpr size_t kUastcModes = 19;
inline constexpr size_t kUastcSolidMode = 8;  ///< one colour of 4 · 8 bits

// Tables "UASTC Mode Index encoding", "Block configuration bits", "Endpoint bits for each mode", "UASTC weight bits for
// each mode", "Block endpoint description prefix".
inline constexpr std::array<UastcMode, kUastcModes> kUastcModeTable = {{
    {0x01, 4, 15, 0, 1, UastcPlanes::one, 3, 4, 6, 3},       // 0
    {0x35, 6, 15, 0, 1, UastcPlanes::one, 3, 2, 8, 1},       // 1
    {0x1d, 5, 15, 5, 2, UastcPlanes::one, 3, 3, 4, 1},       // 2
    {0x03, 5, 15, 4, 3, UastcPlanes::one, 3, 2, 2, 3},       // 3
    {0x13, 5, 15, 5, 2, UastcPlanes::one, 3, 2, 3, 5},       // 4
    {0x0b, 5, 15, 0, 1, UastcPlanes::one, 3, 3, 8, 1},       // 5
    {0x1b, 5, 15, 0, 1, UastcPlanes::selected, 3, 2, 5, 5},  // 6
    {0x07, 5, 15, 5, 2, UastcPlanes::one, 3, 2, 3, 5},       // 7
    {0x17, 5, 0, 0, 0, UastcPlanes::one, 4, 0, 0, 1},        // 8
    {0x0f, 5, 23, 5, 2, UastcPlanes::one, 4, 2, 4, 1},       // 9
    {0x02, 3, 17, 0, 1, UastcPlanes::one, 4, 4, 4, 3},       // 10
    {0x00, 2, 17, 0, 1, UastcPlanes::selected, 4, 2, 4, 3},  // 11
    {0x06, 3, 17, 0, 1, UastcPlanes::one, 4, 3, 6, 3},       // 12
    {0x1f, 5, 23, 0, 1, UastcPlanes::selected, 4, 1, 8, 1},  // 13
    {0x0d, 5, 23, 0, 1, UastcPlanes::one, 4, 2, 8, 1},       // 14
    {0x05, 7, 23, 0, 1, UastcPlanes::one, 2, 4, 8, 1},       // 15
    {0x15, 6, 23, 5, 2, UastcPlanes::one, 2, 2, 8, 1},       // 16
    {0x25, 6, 23, 0, 1, UastcPlanes::alpha, 2, 2, 8, 1},     // 17
    {0x09, 4, 15, 0, 1, UastcPlanes::one, 3, 5, 5, 1},       // 18
}};

/// Subsets of texels in modes 2, 4, 9 and 16: one bit per texel, texel 0 in the lowest bit.
inline constexpr std::array<uint16_t, 30> kUastcPatterns2 = {
    0xcccc, 0x8888, 0x1111, 0xecc8, 0x377f, 0xfeec, 0x0137, 0x137f, 0xc800, 0x0013,
    0xfe80, 0x17ff, 0x0017, 0x00ff, 0xfff0, 0x0fff, 0xff71, 0x8eff, 0x08ce, 0x008c,
    0x7310, 0xceff, 0x7331, 0x088c, 0xceef, 0x6666, 0xf00f, 0x5555, 0x0f0f, 0x36c9};
/// The same for mode 7.
inline constexpr std::array<uint16_t, 19> kUastcPatterns7 = {0x00f0, 0x4444, 0x0133, 0xcc80, 0xf0ff, 0x2222, 0xffc8,
                                                             0xccce, 0x3c03, 0x00ee, 0x7700, 0x3003, 0x00ce, 0xff80,
                                                             0x6fff, 0x1333, 0x11ff, 0x136c, 0x00ef};
/// The same for mode 3, with 2 bits per texel.
inline constexpr std::array<uint32_t, 11> kUastcPatterns3 = {0xa5a50000, 0xaa005555, 0xaa000055, 0x0000aa55,
                                                             0x25252525, 0x94949494, 0x58585858, 0x56560202,
                                                             0x92929292, 0x55aa0055, 0xa05050a0};

}  // namespace relume::detail
