// WebP images, through libwebp.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"
#include "image/stb_decode.h"

namespace relume::detail {

/// Whether the bytes begin with the WebP signature: "RIFF", a size, "WEBP".
bool is_webp(std::span<const std::byte> bytes);

/// Decodes a still image, lossy or lossless, to 8 bits per channel; missing alpha is opaque. Throws Error for damaged
/// files and for animations.
DecodedPixels decode_webp(std::span<const std::byte> bytes, const std::string& name);

/// Reads the size from the header. Throws Error.
ImageSize webp_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
