// Radiance HDR images: 8 bits per channel with a shared exponent.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"
#include "relume/image_io.h"

namespace relume::detail {

/// Parses flat, old and new run-length encoded images, top-down or bottom-up. EXPOSURE lines are divided out. Replaces
/// the packaged stb_image, which loops forever on truncated images. Throws Error.
Image parse_rgbe(std::span<const std::byte> bytes, const std::string& name);

/// Reads the size from the header. Throws Error.
ImageSize rgbe_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
