// Memory for tests of what happens when it runs out.
#pragma once

#include <atomic>
#include <new>

#include "core/array.h"

namespace relume::testing {

/// Memory of the processor in which one allocation fails.
class FailingMemory final : public Memory {
 public:
  /// The allocation after `before` others fails, and later ones succeed.
  void fail_after(int before) {
    left_ = before;
    failed_ = false;
  }
  /// No allocation fails any more.
  void recover() { left_ = kNever; }
  bool failed() const { return failed_; }
  /// Number of blocks in use.
  int blocks() const { return blocks_; }

  void* allocate(size_t bytes, size_t alignment) override {
    if (left_ >= 0 && left_-- == 0) {
      failed_ = true;
      throw std::bad_alloc();
    }
    void* const block = host_memory().allocate(bytes, alignment);
    ++blocks_;
    return block;
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    host_memory().deallocate(block, bytes, alignment);
    --blocks_;
  }

 private:
  static constexpr int kNever = -1;

  std::atomic<int> left_ = kNever;  ///< successful allocations before the one that fails
  std::atomic<bool> failed_ = false;
  std::atomic<int> blocks_ = 0;
};

}  // namespace relume::testing
