// ETC1S textures with BasisLZ supercompression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/ktx2/etc1s_codebooks.h"

namespace relume::detail {

/// Data shared by all slices.
struct Etc1sGlobalData {
  std::vector<Etc1sEndpoint> endpoints;
  std::vector<Etc1sSelector> selectors;
  Etc1sTables tables;
};

/// Decodes an RGB image, or one channel replicated: `width` · `height` · 3 bytes, row by row in stored order. Throws
/// Error.
std::vector<uint8_t> decode_etc1s_slice(std::span<const std::byte> bytes, size_t width, size_t height,
                                        const Etc1sGlobalData& global, const std::string& name);

}  // namespace relume::detail
