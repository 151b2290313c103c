// Numbers in little-endian file formats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace relume::detail {

/// Little-endian number of `size` bytes; bytes beyond the end count as 0.
inline uint64_t number_at(std::span<const std::byte> bytes, size_t offset, size_t size) {
  uint64_t value = 0;
  for (size_t i = 0; i < size && offset + i < bytes.size(); ++i)
    value |= std::to_integer<uint64_t>(bytes[offset + i]) << (8 * i);
  return value;
}

}  // namespace relume::detail
