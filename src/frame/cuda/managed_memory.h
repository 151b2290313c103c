// Memory that a device and the host access at the same addresses, at different times. The driver moves its pages.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "core/array.h"
#include "frame/cuda/memory_budget.h"
#include "frame/cuda/queue.h"

namespace relume::cuda {

/// Managed memory of a device. Before launches, large blocks that the host may have written are moved to the device as
/// a whole, and large blocks are moved to the host when it opens them. Other pages move when they are accessed. Without
/// concurrent access (attribute 89 of the device), the driver moves everything at launches itself. The host must then
/// access no block while any launch of the process runs on the GPU: the functions that open blocks wait for launches,
/// MemoryBudget permits one device for each GPU, and the host copies blocks itself.
class ManagedMemory final : public Memory {
 public:
  /// `limit`: of the total of all blocks, bytes, in addition to that of `budget`. `moves_blocks`: whether the device
  /// has concurrent access.
  ManagedMemory(Queue& queue, size_t limit, std::shared_ptr<MemoryBudget> budget, bool moves_blocks)
      : queue_(queue), limit_(limit), budget_(std::move(budget)), moves_blocks_(moves_blocks) {}
  /// Frees blocks that are left, which must not be used any more.
  ~ManagedMemory() override;
  ManagedMemory(const ManagedMemory&) = delete;
  ManagedMemory& operator=(const ManagedMemory&) = delete;

  const std::shared_ptr<MemoryBudget>& budget() const { return budget_; }

  /// Throws DeviceMemoryError above the limit or if the driver has no more, Error if the device has failed.
  void* allocate(size_t bytes, size_t alignment) override;
  /// Frees the block once the queued work has ended, in free_blocks().
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override;
  /// Wait for the queued work first. Throw as Queue::finish().
  void open_for_reading(const void* block) override { open(static_cast<const std::byte*>(block)); }
  void open_for_writing(void* block) override { open(static_cast<const std::byte*>(block)); }
  void permit_reading(const void* block) override;
  /// With concurrent access, these two are queued. They throw as Queue::check().
  void copy(void* to, const void* from, size_t bytes) override;
  void zero(void* to, size_t bytes) override;

  /// Whether move_to_device() would move a block.
  bool has_moves() const;
  /// Queues the moves of all blocks that the host may have written. Call it before each launch, with the context
  /// current. Throws as Queue::check().
  void move_to_device();
  /// Frees deallocated blocks if the work that was queued before has ended.
  void free_blocks() noexcept;

 private:
  using Blocks = std::map<const std::byte*, size_t>;  ///< address and bytes

  /// Adds bytes to the total, after freeing blocks if necessary. Throws DeviceMemoryError above the limit.
  void reserve(size_t bytes);
  bool try_reserve(size_t bytes);
  void free(const Blocks& blocks) noexcept;
  void give_back(size_t bytes);
  void open(const std::byte* address);
  /// The block of an address, or the end of `blocks`.
  static Blocks::const_iterator find(const Blocks& blocks, const std::byte* address);
  /// Moves the block of an address to the device if the host may have written it.
  void bring(const std::byte* address);
  /// Whether blocks of this size are moved as a whole.
  bool is_moved(size_t bytes) const;
  /// Queues the move of a block, if it is large.
  void move(const Blocks::value_type& block, DeviceNumber to);

  Queue& queue_;
  size_t limit_;
  std::shared_ptr<MemoryBudget> budget_;
  bool moves_blocks_;
  mutable std::mutex mutex_;  ///< guards the rest
  size_t used_ = 0;
  Blocks on_host_;             ///< opened, or new, since the last launch
  Blocks on_device_;           ///< the other blocks
  Blocks unused_;              ///< deallocated, but work may be queued that accesses them
  uint64_t unused_until_ = 0;  ///< Queue::queued() when the last of them was deallocated
};

}  // namespace relume::cuda
