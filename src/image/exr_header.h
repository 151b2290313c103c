// Checks of an EXR file before the OpenEXR library reads it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "image/image_size.h"

namespace relume::detail {

/// Checks the attributes of every header in the file. Throws Error if an attribute exceeds the file, or if windows,
/// tiles or chunk counts need memory out of proportion to the file. The library allocates that memory before it detects
/// missing data. All other checks are the library's.
void check_exr_header(std::span<const std::byte> bytes, const std::string& name);
/// The same for a file of `file_bytes` bytes that begins with `bytes`, which hold its headers.
void check_exr_header(std::span<const std::byte> bytes, const std::string& name, uint64_t file_bytes);

/// Size of the display window. Throws Error.
ImageSize exr_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
