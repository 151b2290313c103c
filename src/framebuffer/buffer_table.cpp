#include "framebuffer/buffer_table.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <stdexcept>
#include <utility>

#include "core/parallel.h"

namespace relume {

Buffer::Buffer(BufferDescription description, uint32_t width, uint32_t height, BlockPool& pool)
    : description_(std::move(description)),
      size_(static_cast<size_t>(width) * height * description_.id.element_bytes),
      data_(pool.take(size_)),
      previous_(description_.double_buffered ? pool.take(size_) : BlockPool::Block()) {}

bool Buffer::clear_new(const std::stop_token& stop) const {
  constexpr size_t kBlock = size_t{1} << 20;
  for (std::byte* half : {data_.get(), previous_.get()}) {
    for (size_t at = 0; is_new_ && half && at < size_; at += kBlock) {
      if (stop.stop_requested()) return false;
      memory().zero(half + at, std::min(kBlock, size_ - at));
    }
  }
  is_new_ = false;
  return true;
}

void Buffer::clear() {
  if (is_new_) return;
  for (std::byte* half : {data_.get(), previous_.get()}) {
    if (half) memory().zero(half, size_);
  }
}

void Buffer::keep() {
  if (!description_.persistent || description_.double_buffered) return;
  if (!kept_) kept_ = data_.get_deleter().pool->take(size_);
  memory().copy(kept_.get(), data(), size_);
}

void Buffer::restore() {
  if (kept_) memory().copy(data_.get(), kept_.get(), size_);
}

void Buffer::fail_type() const {
  throw std::logic_error("buffer '" + std::string(name()) + "': its elements are of another type");
}

Buffer& BufferTable::add(BufferDescription description) {
  assert(find(description.id.name) == nullptr);
  return *buffers_.emplace_back(std::make_unique<Buffer>(std::move(description), width_, height_, *pool_));
}

Buffer* BufferTable::find(std::string_view name) { return const_cast<Buffer*>(std::as_const(*this).find(name)); }

const Buffer* BufferTable::find(std::string_view name) const {
  const auto found = std::find_if(buffers_.begin(), buffers_.end(), [&](const auto& b) { return b->name() == name; });
  return found == buffers_.end() ? nullptr : found->get();
}

size_t BufferTable::memory_bytes() const {
  size_t sum = 0;
  for (const auto& b : buffers_) sum += b->memory_bytes();
  return sum;
}

void BufferTable::swap() {
  for (const auto& b : buffers_) {
    if (b->description().double_buffered) b->swap();
  }
}

bool BufferTable::clear_new(const std::stop_token& stop) {
  std::atomic<bool> complete = true;
  parallel_tasks(buffers_.size(), [&](size_t i) {
    if (!buffers_[i]->clear_new(stop)) complete = false;
  });
  return complete;
}

void BufferTable::keep() {
  parallel_tasks(buffers_.size(), [&](size_t i) { buffers_[i]->keep(); });
}

void BufferTable::restore() {
  parallel_tasks(buffers_.size(), [&](size_t i) { buffers_[i]->restore(); });
}

void BufferTable::reset(Change changes) {
  for (const auto& b : buffers_) {
    if (includes(changes, b->description().reset)) b->clear();
  }
}

}  // namespace relume
