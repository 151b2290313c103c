#include "framebuffer/block_pool.h"

#include <algorithm>
#include <new>
#include <utility>

namespace relume {
namespace {

// A reused block would hide accesses to released buffers from AddressSanitizer.
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kReuses = false;
#else
constexpr bool kReuses = true;
#endif

}  // namespace

BlockPool::Block BlockPool::take(size_t bytes) {
  Return give_back{shared_from_this(), bytes};
  {
    const std::lock_guard lock(mutex_);
    if (const auto found = spare_.find(bytes); found != spare_.end()) {
      spare_bytes_ -= bytes;
      return {spare_.extract(found).mapped().block, std::move(give_back)};
    }
  }
  try {
    return {allocate(bytes), std::move(give_back)};
  } catch (const std::bad_alloc&) {
    clear();
    return {allocate(bytes), Return{shared_from_this(), bytes}};
  }
}

std::byte* BlockPool::allocate(size_t bytes) {
  return static_cast<std::byte*>(memory_.allocate(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__));
}

void BlockPool::free(std::byte* block, size_t bytes) noexcept {
  memory_.deallocate(block, bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}

/// Frees a spare block. Returns the next one.
std::multimap<size_t, BlockPool::Spare>::iterator BlockPool::free(
    std::multimap<size_t, Spare>::iterator spare) noexcept {
  spare_bytes_ -= spare->first;
  free(spare->second.block, spare->first);
  return spare_.erase(spare);
}

void BlockPool::raise_limit(size_t bytes) {
  const std::lock_guard lock(mutex_);
  limit_ = std::max(limit_, bytes);
}

void BlockPool::next_size() {
  const std::lock_guard lock(mutex_);
  ++changes_;
  for (auto spare = spare_.begin(); spare != spare_.end();) {
    const bool old = changes_ - spare->second.since > kKeptChanges;
    spare = old ? free(spare) : std::next(spare);
  }
}

void BlockPool::clear() {
  const std::lock_guard lock(mutex_);
  for (auto spare = spare_.begin(); spare != spare_.end();) spare = free(spare);
}

size_t BlockPool::spare_bytes() const {
  const std::lock_guard lock(mutex_);
  return spare_bytes_;
}

void BlockPool::put_back(std::byte* block, size_t bytes) noexcept {
  const std::lock_guard lock(mutex_);
  if (!kReuses || bytes > limit_) return free(block, bytes);
  try {
    spare_.emplace(bytes, Spare{block, changes_});
  } catch (const std::bad_alloc&) {
    return free(block, bytes);  // without memory for its entry
  }
  spare_bytes_ += bytes;
  while (spare_bytes_ > limit_) free(spare_.begin());
}

}  // namespace relume
