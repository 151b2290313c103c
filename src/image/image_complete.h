// Completeness checks for formats of stb_image, which fills missing data with grey, black or uninitialised memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "image/stb_decode.h"

namespace relume::detail {

/// Whether the bytes at `offset` equal `magic`.
bool starts_with(std::span<const std::byte> bytes, std::string_view magic, size_t offset = 0);

/// Whether a PNG, JPEG or TGA with that many pixels has all its data. True for other formats.
bool is_complete(std::span<const std::byte> bytes, ImageFormat format, uint64_t pixel_count);

}  // namespace relume::detail
