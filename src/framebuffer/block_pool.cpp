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
      return {spare_.extract(found).mapped().block.release(), std::move(give_back)};
    }
  }
  try {
    return {new std::byte[bytes], std::move(give_back)};
  } catch (const std::bad_alloc&) {
    clear();
    return {new std::byte[bytes], Return{shared_from_this(), bytes}};
  }
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
    if (old) spare_bytes_ -= spare->first;
    spare = old ? spare_.erase(spare) : std::next(spare);
  }
}

void BlockPool::clear() {
  const std::lock_guard lock(mutex_);
  spare_.clear();
  spare_bytes_ = 0;
}

size_t BlockPool::spare_bytes() const {
  const std::lock_guard lock(mutex_);
  return spare_bytes_;
}

void BlockPool::put_back(std::byte* block, size_t bytes) noexcept {
  std::unique_ptr<std::byte[]> owned(block);
  const std::lock_guard lock(mutex_);
  if (!kReuses || bytes > limit_) return;
  try {
    spare_.emplace(bytes, Spare{std::move(owned), changes_});
  } catch (const std::bad_alloc&) {
    return;  // without memory for its entry, the block is freed
  }
  spare_bytes_ += bytes;
  while (spare_bytes_ > limit_) {
    spare_bytes_ -= spare_.begin()->first;
    spare_.erase(spare_.begin());
  }
}

}  // namespace relume
