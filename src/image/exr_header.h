// A first look at an EXR file before the OpenEXR library sees it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"

namespace relume::detail {

/// Walks the attributes of every header in the file. Throws Error if one of them claims more bytes than there are, or
/// if windows, tiles or chunk counts ask for memory out of proportion to the file: the library allocates what headers
/// ask for, and only then finds that the data is missing. Everything else is left to the library's own checks.
void check_exr_header(std::span<const std::byte> bytes, const std::string& name);

/// Of the display window. Throws Error.
ImageSize exr_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
