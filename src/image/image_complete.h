// Whether images that stb_image decodes are there to their end: it fills what is missing with grey, black or whatever
// is in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "image/stb_decode.h"

namespace relume::detail {

/// Whether the bytes at `offset` are `magic`.
bool starts_with(std::span<const std::byte> bytes, std::string_view magic, size_t offset = 0);

/// Whether a PNG, JPEG or TGA of that many pixels has all its data. True for other formats.
bool is_complete(std::span<const std::byte> bytes, ImageFormat format, uint64_t pixel_count);

}  // namespace relume::detail
