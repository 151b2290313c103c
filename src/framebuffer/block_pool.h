// Keeps the memory of pixel buffers when the image size changes, and reuses it when an earlier size returns. Freeing
// the buffers of a full-size frame takes the system tens of milliseconds.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "core/array.h"

namespace relume {

class BlockPool : public std::enable_shared_from_this<BlockPool> {
  struct Private {
    explicit Private() = default;
  };

 public:
  /// Deleter that returns a block to its pool.
  struct Return {
    std::shared_ptr<BlockPool> pool;
    size_t bytes = 0;
    void operator()(std::byte* block) const { pool->put_back(block, bytes); }
  };
  using Block = std::unique_ptr<std::byte[], Return>;

  /// A pool of blocks of `memory`, which must outlive it.
  static std::shared_ptr<BlockPool> create(Memory& memory = host_memory()) {
    return std::make_shared<BlockPool>(Private(), memory);
  }
  BlockPool(Private, Memory& memory) : memory_(memory) {}
  ~BlockPool() { clear(); }
  BlockPool(const BlockPool&) = delete;
  BlockPool& operator=(const BlockPool&) = delete;

  Memory& memory() const { return memory_; }

  /// An uninitialised block: a spare one of that size, or a new one. Frees spare blocks if memory is short. Throws
  /// std::bad_alloc. Thread-safe.
  Block take(size_t bytes);

  /// Raises the limit of spare_bytes(), initially 0. Above it, the smallest spare blocks are freed.
  void raise_limit(size_t bytes);

  /// Call after each change of the image size: frees blocks that have been spare for more than kKeptChanges changes.
  void next_size();
  static constexpr uint32_t kKeptChanges = 16;

  /// Frees all spare blocks.
  void clear();

  size_t spare_bytes() const;

 private:
  struct Spare {
    std::byte* block = nullptr;
    uint32_t since = 0;  ///< value of changes_ when the block became spare
  };

  std::byte* allocate(size_t bytes);
  void put_back(std::byte* block, size_t bytes) noexcept;
  void free(std::byte* block, size_t bytes) noexcept;
  std::multimap<size_t, Spare>::iterator free(std::multimap<size_t, Spare>::iterator spare) noexcept;

  Memory& memory_;
  mutable std::mutex mutex_;
  std::multimap<size_t, Spare> spare_;  ///< by size
  size_t spare_bytes_ = 0;
  size_t limit_ = 0;
  uint32_t changes_ = 0;
};

}  // namespace relume
