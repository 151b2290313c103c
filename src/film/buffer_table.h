// The named per-pixel buffers of a session. Passes exchange data through them; AOVs, the inspector, checkpoints and
// memory reports derive from this table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/ray.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

enum class BufferType : uint8_t { f32, rgb32f, vec2f, u32, hit, fixed_rgb };

/// What makes a buffer's content invalid.
enum class ResetOn : uint8_t {
  nothing,     ///< rewritten every frame
  any_change,  ///< camera, scene or settings differ from those that filled it
};

struct BufferDescription {
  std::string name;
  BufferType type = BufferType::f32;
  std::string help;         ///< one line, for the inspector and `--aov`
  bool persistent = false;  ///< survives the frame: goes into checkpoints
  ResetOn reset = ResetOn::nothing;
  bool shown = false;  ///< offered as an AOV
};

/// Bytes of one element.
size_t element_size(BufferType type);

/// A width × height array; row 0 on top.
class Buffer {
 public:
  Buffer(BufferDescription description, uint32_t width, uint32_t height);

  const BufferDescription& description() const { return description_; }
  std::span<std::byte> bytes() { return {data_.get(), size_}; }
  std::span<const std::byte> bytes() const { return {data_.get(), size_}; }
  void clear();

  /// Elements as T; T's size must be the element size.
  template <typename T>
  View<T> view() const {
    return {reinterpret_cast<T*>(data_.get()), static_cast<uint32_t>(size_ / sizeof(T))};
  }

 private:
  BufferDescription description_;
  size_t size_;
  std::unique_ptr<std::byte[]> data_;
};

class BufferTable {
 public:
  BufferTable(uint32_t width, uint32_t height) : width_(width), height_(height) {}

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// Adds a buffer of zeros; names are unique. The reference stays valid.
  Buffer& add(BufferDescription description);

  /// nullptr if there is none.
  Buffer* find(std::string_view name);
  const Buffer* find(std::string_view name) const;

  std::span<const std::unique_ptr<Buffer>> all() const { return buffers_; }
  size_t memory_bytes() const;

  /// Clears what `ResetOn::any_change` marks.
  void reset();

 private:
  uint32_t width_;
  uint32_t height_;
  std::vector<std::unique_ptr<Buffer>> buffers_;
};

}  // namespace relume
