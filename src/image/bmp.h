// BMP images, which stb_image decodes in part only.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"
#include "image/stb_decode.h"

namespace relume::detail {

/// Decodes BMP with headers of Windows (BITMAPINFOHEADER and later) and OS/2: 1, 4, 8, 16, 24 and 32 bits a pixel,
/// colour masks, run lengths (RLE4, RLE8), rows from below or from above. 32 bits a pixel without masks are RGBA, or
/// RGB where all alpha is 0. Throws Error, which names an unsupported feature.
DecodedPixels decode_bmp(std::span<const std::byte> bytes, const std::string& name);

/// From the header. Throws Error.
ImageSize bmp_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
