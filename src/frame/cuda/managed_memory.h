// Memory that a device and the host access at the same addresses, at different times. The driver moves its pages.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>

#include "core/array.h"
#include "frame/cuda/queue.h"

namespace relume::cuda {

/// Managed memory of a device. Before launches, blocks that the host may have written are moved to the device as a
/// whole; large blocks are moved to the host when it opens them. Other pages move when they are accessed. Without
/// concurrent access (attribute 89 of the device), the driver moves everything at launches itself; the host must then
/// access no block while a launch runs, which the functions that open blocks ensure, and copies blocks itself.
class ManagedMemory final : public Memory {
 public:
  /// `limit`: of the total of all blocks, bytes. `moves_blocks`: whether the device has concurrent access.
  ManagedMemory(Queue& queue, size_t limit, bool moves_blocks)
      : queue_(queue), limit_(limit), moves_blocks_(moves_blocks) {}
  /// Frees blocks that are left, which must not be used any more.
  ~ManagedMemory() override;
  ManagedMemory(const ManagedMemory&) = delete;
  ManagedMemory& operator=(const ManagedMemory&) = delete;

  /// Throws DeviceMemoryError above the limit or if the driver has no more, Error if the device has failed.
  void* allocate(size_t bytes, size_t alignment) override;
  /// Waits for the queued launches first, as do the next three, which throw as Queue::finish().
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override;
  void open_for_reading(const void* block) override { open(static_cast<const std::byte*>(block)); }
  void open_for_writing(void* block) override { open(static_cast<const std::byte*>(block)); }
  void permit_reading(const void* block) override;
  /// With concurrent access, these two are queued. They throw as Queue::check().
  void copy(void* to, const void* from, size_t bytes) override;
  void zero(void* to, size_t bytes) override;

  /// Queues the moves of all blocks that the host may have written. Call it before each launch, with the context
  /// current. Throws as Queue::check().
  void move_to_device();

  /// Total of all blocks, bytes.
  size_t used_bytes() const;
  size_t limit_bytes() const { return limit_; }

 private:
  using Blocks = std::map<const std::byte*, size_t>;  ///< address and bytes

  /// Adds bytes to the total. Throws DeviceMemoryError above the limit.
  void reserve(size_t bytes);
  void give_back(size_t bytes);
  void open(const std::byte* address);
  /// The block of an address, or the end of `blocks`.
  static Blocks::const_iterator find(const Blocks& blocks, const std::byte* address);
  /// Moves the block of an address to the device if the host may have written it.
  void bring(const std::byte* address);
  void move(const Blocks::value_type& block, DeviceNumber to);

  Queue& queue_;
  size_t limit_;
  bool moves_blocks_;
  mutable std::mutex mutex_;  ///< guards the rest
  size_t used_ = 0;
  Blocks on_host_;    ///< opened, or new, since the last launch
  Blocks on_device_;  ///< the other blocks
};

}  // namespace relume::cuda
