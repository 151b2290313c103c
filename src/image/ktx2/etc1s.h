// ETC1S textures with BasisLZ supercompression.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "image/ktx2/etc1s_codebooks.h"

namespace relume::detail {

/// Everything that slices refer to.
struct Etc1sGlobalData {
  std::vector<Etc1sEndpoint> endpoints;
  std::vector<Etc1sSelector> selectors;
  Etc1sTables tables;
};

/// Decodes an image of RGB, or one channel replicated: `width` · `height` · 3 bytes, row by row as stored. Throws
/// Error.
std::vector<uint8_t> decode_etc1s_slice(std::span<const std::byte> bytes, size_t width, size_t height,
                                        const Etc1sGlobalData& global, const std::string& name);

}  // namespace relume::detail
