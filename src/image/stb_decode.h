// Image files of integers: BMP by bmp.cpp, KTX2 by ktx2/, WebP by webp.cpp, the other formats that relume documents
// through stb_image.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relume::detail {

enum class ImageFormat { exr, hdr, png, jpeg, bmp, tga, ktx2, webp };

/// By the first bytes. Throws Error for everything else (GIF, PSD, DDS …), naming what was recognised.
ImageFormat detect_image_format(std::span<const std::byte> bytes, const std::string& name);

/// Samples as stored: one of the vectors is filled, tightly packed, row by row from the top.
struct DecodedPixels {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> rgba8;
  std::vector<uint16_t> rgba16;  ///< PNG with 16 bits a channel
  bool linear = false;           ///< KTX2 says that RGB is linear; else it is sRGB, or unknown
};

/// Decodes PNG, JPEG, BMP, TGA, KTX2 or WebP. Grey is replicated, missing alpha is opaque. Throws Error.
DecodedPixels decode_pixels(std::span<const std::byte> bytes, ImageFormat format, const std::string& name);

}  // namespace relume::detail
