// Per-pixel buffers of a session, for inspection.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace relume {

enum class ElementType : uint8_t { float32, uint32 };

/// A per-pixel buffer as an array of height × width × channels elements. Row 0 is the top row.
struct BufferInfo {
  std::string name;
  std::string help;
  ElementType type = ElementType::float32;
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t channels = 1;
  size_t pixel_stride = 0;  ///< bytes from one pixel to the next
  size_t row_stride = 0;    ///< bytes from one row to the next
};

/// Read access to a buffer, valid until the session's next non-const call.
struct BufferData {
  BufferInfo info;
  std::span<const std::byte> bytes;
};

}  // namespace relume
