// The named per-pixel buffers of a session. Passes exchange data through them; AOVs, the inspector, checkpoints and
// memory reports derive from this table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/change.h"
#include "core/view.h"
#include "framebuffer/block_pool.h"
#include "framebuffer/buffer_key.h"

namespace relume {

/// How a buffer is displayed.
enum class BufferDisplay : uint8_t {
  hidden,  ///< not displayed
  value,   ///< unchanged
  mean,    ///< divided by the number of frames
};

struct BufferDescription {
  BufferId id = {};
  std::string help = {};         ///< one line, for the inspector and `--aov`
  bool persistent = false;       ///< survives the frame and is saved in checkpoints
  bool double_buffered = false;  ///< whether the previous frame's content stays readable
  Change reset = Change::none;   ///< changes that invalidate the content
  bool follows_surface = false;  ///< whether reprojection moves the content with the surface
  BufferDisplay display = BufferDisplay::hidden;
  std::string_view channels = "";  ///< one letter per channel of the EXR layer; empty: RGB, XY or Y by type
};

/// A width × height array, initially zero; row 0 on top. Memory is first touched when the content is accessed, or by
/// clear_new(), which can be stopped.
class Buffer {
 public:
  Buffer(BufferDescription description, uint32_t width, uint32_t height, BlockPool& pool);

  const BufferDescription& description() const { return description_; }
  std::string_view name() const { return description_.id.name; }
  /// The content for host code, as Array::write() and Array::read().
  std::span<std::byte> bytes() { return opened(data()); }
  std::span<const std::byte> bytes() const { return opened(static_cast<const std::byte*>(data())); }
  /// Content of the previous frame; empty unless double-buffered.
  std::span<std::byte> previous_bytes() { return opened(previous_data()); }
  std::span<const std::byte> previous_bytes() const { return opened(static_cast<const std::byte*>(previous_data())); }
  /// Writes the zeros of a new buffer. Returns false if `stop` was requested first; the buffer is then still new.
  bool clear_new(const std::stop_token& stop = {}) const;
  void clear();
  /// Copies content that a frame changes in place, for restore().
  void keep();
  /// Restores the content of the last keep(), if it made a copy.
  void restore();
  void swap() { std::swap(data_, previous_); }
  size_t memory_bytes() const { return size_ * (size_t{1} + (previous_ ? 1 : 0) + (kept_ ? 1 : 0)); }

  /// Elements as T, which must match the buffer's type, for host code that reads them.
  template <typename T>
  View<const T> read() const {
    const View<const T> elements = view<const T>();
    opened(reinterpret_cast<const std::byte*>(elements.data));
    return elements;
  }
  /// The same for kernels.
  template <typename T>
  View<T> view() const {
    check_type<T>();
    return {reinterpret_cast<T*>(data()), static_cast<uint32_t>(size_ / sizeof(T))};
  }
  /// The same as elements of another type of equal size, for kernels that only move them.
  template <typename T>
  View<T> view_as() const {
    if (description_.id.element_bytes != sizeof(T)) fail_type();
    return {reinterpret_cast<T*>(data()), static_cast<uint32_t>(size_ / sizeof(T))};
  }
  /// Elements of the previous frame; an empty view unless double-buffered.
  template <typename T>
  View<T> previous() const {
    check_type<T>();
    return {reinterpret_cast<T*>(previous_data()), static_cast<uint32_t>(previous_ ? size_ / sizeof(T) : 0)};
  }

 private:
  Memory& memory() const { return data_.get_deleter().pool->memory(); }
  /// Gives the host access to one of the buffer's blocks, or none.
  std::span<std::byte> opened(std::byte* block) const {
    if (block) memory().open_for_writing(block);
    return {block, block ? size_ : 0};
  }
  std::span<const std::byte> opened(const std::byte* block) const {
    if (block) memory().open_for_reading(block);
    return {block, block ? size_ : 0};
  }
  std::byte* data() const {
    if (is_new_) clear_new();
    return data_.get();
  }
  std::byte* previous_data() const {
    if (is_new_) clear_new();
    return previous_.get();
  }
  template <typename T>
  void check_type() const {
    using Element = std::remove_const_t<T>;
    if (description_.id != BufferId(BufferKey<Element>{name()})) fail_type();
  }
  /// Throws std::logic_error: an error in the code, not in user input.
  [[noreturn]] void fail_type() const;

  BufferDescription description_;
  size_t size_;
  BlockPool::Block data_;
  BlockPool::Block previous_;
  BlockPool::Block kept_;       ///< copy made by keep()
  mutable bool is_new_ = true;  ///< whether data_ and previous_ are still uninitialised
};

class BufferTable {
 public:
  /// Buffers take their memory from `pool`, and return it.
  BufferTable(uint32_t width, uint32_t height, std::shared_ptr<BlockPool> pool = BlockPool::create())
      : width_(width), height_(height), pool_(std::move(pool)) {}

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }

  /// Adds a zero-filled buffer with a unique name. The reference stays valid.
  Buffer& add(BufferDescription description);

  /// Returns nullptr if no buffer has that name.
  Buffer* find(std::string_view name);
  const Buffer* find(std::string_view name) const;

  /// Elements of a buffer for host code that reads them; an empty view if the table lacks it.
  template <typename T>
  View<const T> read(const BufferKey<T>& key) const {
    const Buffer* buffer = find(key.name);
    return buffer ? buffer->read<T>() : View<const T>{};
  }
  /// The same for kernels.
  template <typename T>
  View<const T> view(const BufferKey<T>& key) const {
    const Buffer* buffer = find(key.name);
    return buffer ? buffer->view<const T>() : View<const T>{};
  }
  template <typename T>
  View<T> mutable_view(const BufferKey<T>& key) {
    const Buffer* buffer = find(key.name);
    return buffer ? buffer->view<T>() : View<T>{};
  }
  /// Elements of a buffer in the previous frame.
  template <typename T>
  View<const T> previous(const BufferKey<T>& key) const {
    const Buffer* buffer = find(key.name);
    return buffer ? buffer->previous<const T>() : View<const T>{};
  }

  std::span<const std::unique_ptr<Buffer>> all() const { return buffers_; }
  size_t memory_bytes() const;

  /// Starts a frame: the content of double-buffered buffers becomes the previous frame's.
  void swap();
  /// Writes the zeros of all new buffers. Returns false if `stop` was requested first.
  bool clear_new(const std::stop_token& stop);
  /// Copies content that a frame changes in place: persistent buffers that are not double-buffered.
  void keep();
  /// Restores these copies after an abandoned frame. Double-buffered content needs swap() as well.
  void restore();
  /// Clears buffers that `changes` invalidate.
  void reset(Change changes);

 private:
  uint32_t width_;
  uint32_t height_;
  std::shared_ptr<BlockPool> pool_;
  std::vector<std::unique_ptr<Buffer>> buffers_;
};

}  // namespace relume
