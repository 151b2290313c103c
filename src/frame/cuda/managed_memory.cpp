#include "frame/cuda/managed_memory.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::cuda {
namespace {

/// From this size on, moving a block as a whole takes less time than accesses that move single pages.
constexpr size_t kMovedBytes = size_t{64} * 1024;

DeviceAddress address_of(const void* block) { return reinterpret_cast<uintptr_t>(block); }

std::string mebibytes(size_t bytes) { return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1024 * 1024)); }

}  // namespace

ManagedMemory::~ManagedMemory() {
  queue_.free_objects([&] { queue_.driver().cuStreamSynchronize(queue_.stream()); });
  for (const Blocks* blocks : {&on_host_, &on_device_, &unused_}) free(*blocks);
}

bool ManagedMemory::try_reserve(size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes > limit_ - used_ || !budget_->take(bytes)) return false;
  used_ += bytes;
  return true;
}

void ManagedMemory::reserve(size_t bytes) {
  if (try_reserve(bytes)) return;
  {
    const Queue::Current current(queue_);
    queue_.finish();
  }
  free_blocks();
  if (try_reserve(bytes)) return;
  const std::lock_guard lock(mutex_);
  const bool is_own = bytes > limit_ - used_;
  throw DeviceMemoryError(
      fmt::format("{} has no room for {}: {} of {} are in use; use a smaller image or scene, or "
                  "end other programs that use the GPU",
                  queue_.device_name(), mebibytes(bytes), mebibytes(is_own ? used_ : budget_->used_bytes()),
                  mebibytes(is_own ? limit_ : budget_->limit_bytes())));
}

void ManagedMemory::give_back(size_t bytes) {
  const std::lock_guard lock(mutex_);
  used_ -= bytes;
  budget_->give_back(bytes);
}

void ManagedMemory::free(const Blocks& blocks) noexcept {
  if (blocks.empty()) return;
  size_t bytes = 0;
  for (const Blocks::value_type& block : blocks) bytes += block.second;
  queue_.free_objects([&] {
    for (const Blocks::value_type& block : blocks) queue_.driver().cuMemFree(address_of(block.first));
  });
  give_back(bytes);
}

void ManagedMemory::free_blocks() noexcept {
  Blocks freed;
  {
    const std::lock_guard lock(mutex_);
    if (queue_.has_finished(unused_until_)) freed.swap(unused_);
  }
  free(freed);
}

void* ManagedMemory::allocate(size_t bytes, size_t alignment) {
  const size_t counted = std::max<size_t>(bytes, 1);  // the driver refuses 0
  reserve(counted);
  DeviceAddress address = 0;
  try {
    const Queue::Current current(queue_);
    queue_.check(queue_.driver().cuMemAllocManaged(&address, counted, kAttachGlobal),
                 fmt::format("allocating {}", mebibytes(bytes)));
    if (address % alignment != 0) {
      throw DeviceMemoryError(
          fmt::format("{} has no blocks that are aligned to {} bytes", queue_.device_name(), alignment));
    }
    auto* const block = reinterpret_cast<std::byte*>(address);  // NOLINT(performance-no-int-to-ptr)
    const std::lock_guard lock(mutex_);
    on_host_.emplace(block, counted);
    return block;
  } catch (...) {
    if (address != 0) queue_.free_objects([&] { queue_.driver().cuMemFree(address); });
    give_back(counted);
    throw;
  }
}

void ManagedMemory::deallocate(void* block, size_t, size_t) noexcept {
  {
    const std::lock_guard lock(mutex_);
    auto node = on_host_.extract(static_cast<const std::byte*>(block));
    if (node.empty()) node = on_device_.extract(static_cast<const std::byte*>(block));
    assert(!node.empty() && "no such block");
    if (node.empty()) return;
    unused_.insert(std::move(node));
    unused_until_ = queue_.queued();
  }
  free_blocks();
}

bool ManagedMemory::is_moved(size_t bytes) const { return moves_blocks_ && bytes >= kMovedBytes; }

void ManagedMemory::move(const Blocks::value_type& block, DeviceNumber to) {
  const auto& [address, bytes] = block;
  if (!is_moved(bytes)) return;
  const Result result = queue_.driver().cuMemPrefetchAsync(address_of(address), bytes, to, queue_.stream());
  if (result != Result::success) queue_.check(result, fmt::format("moving {}", mebibytes(bytes)));
}

ManagedMemory::Blocks::const_iterator ManagedMemory::find(const Blocks& blocks, const std::byte* address) {
  const auto after = blocks.upper_bound(address);
  if (after == blocks.begin()) return blocks.end();
  const auto block = std::prev(after);
  return address < block->first + block->second ? block : blocks.end();
}

void ManagedMemory::open(const std::byte* address) {
  queue_.check_usable();
  {
    // Host code may open a block for each element that it writes.
    const std::lock_guard lock(mutex_);
    if (queue_.idle() && find(on_device_, address) == on_device_.end()) return;
  }
  const Queue::Current current(queue_);
  queue_.finish();
  free_blocks();
  const std::lock_guard lock(mutex_);
  const auto block = find(on_device_, address);
  if (block == on_device_.end()) return;
  move(*block, kHostDevice);
  if (is_moved(block->second)) queue_.wait_for_stream("moving memory to the host");
  on_host_.insert(on_device_.extract(block));
}

void ManagedMemory::permit_reading(const void*) {
  queue_.check_usable();
  if (queue_.idle()) return;
  const Queue::Current current(queue_);
  queue_.finish();
}

void ManagedMemory::bring(const std::byte* address) {
  const auto block = find(on_host_, address);
  if (block == on_host_.end()) return;
  move(*block, queue_.device());
  // The block must not be freed before its move, even if the driver refuses the work that needs it.
  if (is_moved(block->second)) queue_.added();
  on_device_.insert(on_host_.extract(block));
}

void ManagedMemory::copy(void* to, const void* from, size_t bytes) {
  if (!moves_blocks_) return Memory::copy(to, from, bytes);
  if (bytes == 0) return;
  const Queue::Current current(queue_);
  queue_.submit();
  const std::lock_guard lock(mutex_);
  bring(static_cast<const std::byte*>(from));
  bring(static_cast<const std::byte*>(to));
  const Result result = queue_.driver().cuMemcpyDtoDAsync(address_of(to), address_of(from), bytes, queue_.stream());
  if (result != Result::success) queue_.check(result, fmt::format("copying {}", mebibytes(bytes)));
  queue_.added();
}

void ManagedMemory::zero(void* to, size_t bytes) {
  if (!moves_blocks_) return Memory::zero(to, bytes);
  if (bytes == 0) return;
  const Queue::Current current(queue_);
  queue_.submit();
  const std::lock_guard lock(mutex_);
  bring(static_cast<const std::byte*>(to));
  const Result result = queue_.driver().cuMemsetD8Async(address_of(to), 0, bytes, queue_.stream());
  if (result != Result::success) queue_.check(result, fmt::format("clearing {}", mebibytes(bytes)));
  queue_.added();
}

bool ManagedMemory::has_moves() const {
  const std::lock_guard lock(mutex_);
  return std::any_of(on_host_.begin(), on_host_.end(), [&](const auto& block) { return is_moved(block.second); });
}

void ManagedMemory::move_to_device() {
  const std::lock_guard lock(mutex_);
  for (const Blocks::value_type& block : on_host_) move(block, queue_.device());
  on_device_.merge(on_host_);
}

}  // namespace relume::cuda
