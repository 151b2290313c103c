// Integer image formats: BMP by bmp.cpp, KTX2 by ktx2/, WebP by webp.cpp, the other documented formats by stb_image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relume::detail {

enum class ImageFormat { exr, hdr, png, jpeg, bmp, tga, ktx2, webp };

/// Detects the format from the first bytes. Throws Error for all other formats (GIF, PSD, DDS …) and names recognised
/// ones.
ImageFormat detect_image_format(std::span<const std::byte> bytes, const std::string& name);

/// Samples as stored. One of the vectors is filled, tightly packed, row by row from the top.
struct DecodedPixels {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgba8;
  std::vector<uint16_t> rgba16;  ///< PNG with 16 bits per channel
  bool linear = false;           ///< whether a KTX2 file declares linear RGB; otherwise sRGB or unknown
};

/// Decodes PNG, JPEG, BMP, TGA, KTX2 or WebP. Grey is replicated, missing alpha is opaque. Throws Error.
DecodedPixels decode_pixels(std::span<const std::byte> bytes, ImageFormat format, const std::string& name);

}  // namespace relume::detail
