// Limits of the image readers on the memory that hostile files can allocate.
#pragma once

#include <cstdint>
#include <string>

namespace relume::detail {

/// Throws Error unless `file_bytes` suffice for width × height pixels of `bytes_per_pixel` when decoded.
/// `max_expansion` is an upper bound on decoded bytes per file byte, which no encoder of the format reaches.
void check_image_size(const std::string& name, int64_t width, int64_t height, int64_t bytes_per_pixel,
                      uint64_t file_bytes, int64_t max_expansion);

}  // namespace relume::detail
