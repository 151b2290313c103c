// Radiance HDR images: 8 bits a channel with a shared exponent.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "image/image_size.h"
#include "relume/image_io.h"

namespace relume::detail {

/// Flat, old and new run-length encoded images, stored from top to bottom or from bottom to top. EXPOSURE lines
/// are divided out. Own code because the packaged stb_image loops forever on images that are cut off.
/// Throws Error.
Image parse_rgbe(std::span<const std::byte> bytes, const std::string& name);

/// From the header. Throws Error.
ImageSize rgbe_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
