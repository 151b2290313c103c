#include "film/buffer_table.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#include "core/fixed_point.h"

namespace relume {

size_t element_size(const BufferDescription& description) {
  switch (description.type) {
    case BufferType::f32: return sizeof(float);
    case BufferType::rgb32f: return sizeof(Rgb);
    case BufferType::vec2f: return sizeof(Vec2);
    case BufferType::u32: return sizeof(uint32_t);
    case BufferType::hit: return sizeof(Hit);
    case BufferType::fixed_rgb: return sizeof(FixedPointRgb);
    case BufferType::record: return description.record_bytes;
  }
  return 0;
}

Buffer::Buffer(BufferDescription description, uint32_t width, uint32_t height)
    : description_(std::move(description)),
      size_(static_cast<size_t>(width) * height * element_size(description_)),
      data_(std::make_unique<std::byte[]>(size_)),
      previous_(description_.double_buffered ? std::make_unique<std::byte[]>(size_) : nullptr) {}

void Buffer::clear() {
  std::memset(data_.get(), 0, size_);
  if (previous_) std::memset(previous_.get(), 0, size_);
}

Buffer& BufferTable::add(BufferDescription description) {
  assert(find(description.name) == nullptr);
  return *buffers_.emplace_back(std::make_unique<Buffer>(std::move(description), width_, height_));
}

Buffer* BufferTable::find(std::string_view name) { return const_cast<Buffer*>(std::as_const(*this).find(name)); }

const Buffer* BufferTable::find(std::string_view name) const {
  const auto found =
      std::find_if(buffers_.begin(), buffers_.end(), [&](const auto& b) { return b->description().name == name; });
  return found == buffers_.end() ? nullptr : found->get();
}

size_t BufferTable::memory_bytes() const {
  size_t sum = 0;
  for (const auto& b : buffers_) sum += b->bytes().size() + b->previous_bytes().size();
  return sum;
}

void BufferTable::swap() {
  for (const auto& b : buffers_) {
    if (b->description().double_buffered) b->swap();
  }
}

void BufferTable::reset(Change changes) {
  for (const auto& b : buffers_) {
    if (includes(changes, b->description().reset)) b->clear();
  }
}

}  // namespace relume
