// Shared by the image readers: limits that keep hostile files from costing more than they should.
#pragma once

#include <cstdint>
#include <string>

namespace relume::detail {

/// Throws Error unless a file of `file_bytes` may hold width × height pixels that take `bytes_per_pixel` when
/// decoded. `max_expansion` bounds decoded bytes per file byte; no encoder of the format reaches it.
void check_image_size(const std::string& name, int64_t width, int64_t height, int64_t bytes_per_pixel,
                      uint64_t file_bytes, int64_t max_expansion);

}  // namespace relume::detail
