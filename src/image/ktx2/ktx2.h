// KTX 2.0 textures.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relume::detail {

/// Level 0 of a 2D texture.
struct Ktx2Image {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgba8;  ///< tightly packed, row by row as stored, which is from the top
  bool is_srgb = false;        ///< RGB has the transfer function of sRGB, else it is linear
  bool has_alpha = false;      ///< else alpha is 255
};

/// Whether the bytes begin as KTX 2.0 files do.
bool is_ktx2(std::span<const std::byte> bytes);

/// Decodes UASTC LDR 4×4, ETC1S with BasisLZ, and 8-bit R, RG, RGB and RGBA; all but ETC1S may have Zstandard
/// supercompression. Channels that the file lacks are 0, alpha 255; greyscale UASTC and ETC1S is replicated to RGB.
/// KTXswizzle rearranges the channels that are stored. KTXorientation is ignored: it does not change which texel
/// belongs to which texture coordinates. Throws Error, which names an unsupported feature.
Ktx2Image decode_ktx2(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
