// Memory for tests of what happens when it runs out.
#pragma once

#include <atomic>
#include <limits>
#include <new>

#include "core/array.h"

namespace relume::testing {

/// Host memory in which allocations fail.
class FailingMemory final : public Memory {
 public:
  /// The allocation after `before` others fails, and `failures` − 1 after it. Later ones succeed.
  void fail_after(int before, int failures = 1) {
    allocations_ = 0;
    failures_ = failures;
    before_ = before;
    failed_ = false;
  }
  /// No allocation fails any more.
  void recover() { before_ = kNever; }
  bool failed() const { return failed_; }
  /// Number of blocks in use.
  int blocks() const { return blocks_; }

  void* allocate(size_t bytes, size_t alignment) override {
    const int number = allocations_++;
    if (number >= before_ && number - before_ < failures_) {
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
  static constexpr int kNever = std::numeric_limits<int>::max();

  std::atomic<int> allocations_ = 0;  ///< since fail_after()
  std::atomic<int> before_ = kNever;  ///< number of successful allocations before those that fail
  std::atomic<int> failures_ = 1;
  std::atomic<bool> failed_ = false;
  std::atomic<int> blocks_ = 0;
};

}  // namespace relume::testing
