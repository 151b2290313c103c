// UASTC LDR 4×4 textures: a subset of ASTC with blocks of 16 bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace relume::detail {

inline constexpr size_t kUastcBlockBytes = 16;

/// RGBA of 4 × 4 texels, row by row.
using UastcTexels = std::array<std::array<uint8_t, 4>, 16>;

/// Decodes a block. `srgb`: rounds as for textures with an sRGB transfer function. Invalid blocks become magenta, as
/// the format specifies.
UastcTexels decode_uastc_block(std::span<const std::byte, kUastcBlockBytes> block, bool srgb);

/// Decodes an image of `width` · `height` texels to RGBA, row by row in stored order. `blocks` contains all of its
/// blocks.
std::vector<uint8_t> decode_uastc(std::span<const std::byte> blocks, size_t width, size_t height, bool srgb);

}  // namespace relume::detail
