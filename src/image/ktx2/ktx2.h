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
  std::vector<uint8_t> rgba8;  ///< tightly packed, row by row in stored order, which is top-down
  bool is_srgb = false;        ///< whether RGB has the sRGB transfer function; otherwise it is linear
  bool has_alpha = false;      ///< otherwise alpha is 255
};

/// Whether the bytes begin with the KTX 2.0 identifier.
bool is_ktx2(std::span<const std::byte> bytes);

/// Decodes UASTC LDR 4×4, ETC1S with BasisLZ, and 8-bit R, RG, RGB and RGBA; all except ETC1S also with Zstandard.
/// Missing channels are 0, missing alpha 255; greyscale UASTC and ETC1S is replicated to RGB. Applies KTXswizzle, not
/// KTXorientation, which does not affect texture coordinates. Throws Error that names an unsupported feature.
Ktx2Image decode_ktx2(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
