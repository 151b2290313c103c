// Headers of KTX 2.0 files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace relume::detail {

enum class Ktx2Supercompression : uint32_t { none = 0, basis_lz = 1, zstandard = 2 };

/// Texel encoding below supercompression.
enum class Ktx2Encoding { plain, etc1s, uastc };

/// A valid header. Spans point into the file.
struct Ktx2Header {
  int64_t width = 0;
  int64_t height = 0;
  uint64_t level_count = 1;
  Ktx2Encoding encoding = Ktx2Encoding::plain;
  Ktx2Supercompression supercompression = Ktx2Supercompression::none;
  size_t plain_channels = 0;      ///< bytes per texel of Ktx2Encoding::plain, 1 to 4
  size_t slices = 1;              ///< slices of Ktx2Encoding::etc1s; 2: RGB and one channel, decoded to alpha
  std::string channels = "rgba";  ///< sources of R, G, B and A among the stored channels: r, g, b, a, 0, 1
  std::string swizzle = "rgba";   ///< sources among `channels`: KTXswizzle, or the format's default
  bool is_srgb = false;
  bool has_alpha = false;           ///< before the swizzle
  std::span<const std::byte> data;  ///< level 0
  uint64_t uncompressed_bytes = 0;  ///< declared size of level 0
  std::span<const std::byte> global_data;
};

/// Reads the header, the level index, the data format descriptor and the key/value data. Throws Error.
Ktx2Header read_ktx2_header(std::span<const std::byte> bytes, const std::string& name);

}  // namespace relume::detail
