// BMP images, which stb_image supports only partially.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"
#include "image/stb_decode.h"

namespace relume::detail {

/// Decodes BMP with headers of Windows (BITMAPINFOHEADER and later) and OS/2. Supports 1, 4, 8, 16, 24 and 32 bits per
/// pixel, colour masks, run lengths (RLE4, RLE8), bottom-up and top-down rows. 32 bits per pixel without masks are
/// RGBA, or RGB if all alpha is 0. Throws Error that names an unsupported feature.
DecodedPixels decode_bmp(std::span<const std::byte> bytes, const std::string& name);

/// Reads the size from the header. Throws Error.
ImageSize bmp_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
