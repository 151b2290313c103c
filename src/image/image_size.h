// Image sizes without decoding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace relume::detail {

/// Size in pixels.
struct ImageSize {
  int64_t width = 0;
  int64_t height = 0;
};

/// Size of an image in any format of parse_image(), from the header alone; the data may still be damaged. Throws Error
/// for damaged headers.
ImageSize read_image_size(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
