#include "core/array.h"

#include <sys/mman.h>

#include <algorithm>
#include <new>
#include <stdexcept>
#include <string>

namespace relume {
namespace {

/// Size of the huge pages of x86-64, and of AArch64 with pages of 4 KiB, in bytes.
constexpr size_t kHugePage = size_t{2} << 20;
/// Minimum size of a block for which the allocator requests huge pages, in bytes. The system then maps a hundredth of
/// the pages, and the processor translates addresses faster.
constexpr size_t kLargeBlock = 2 * kHugePage;

class HostMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override {
    const size_t own = alignment_of(bytes, alignment);
    if (is_default(own)) return ::operator new(bytes);
    void* const block = ::operator new(bytes, std::align_val_t(own));
    if (bytes >= kLargeBlock) madvise(block, bytes / kHugePage * kHugePage, MADV_HUGEPAGE);  // may fail: only advice
    return block;
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    const size_t own = alignment_of(bytes, alignment);
    if (is_default(own)) {
      ::operator delete(block, bytes);
    } else {
      ::operator delete(block, bytes, std::align_val_t(own));
    }
  }

 private:
  static size_t alignment_of(size_t bytes, size_t alignment) {
    return bytes >= kLargeBlock ? std::max(alignment, kHugePage) : alignment;
  }
  static bool is_default(size_t alignment) { return alignment <= __STDCPP_DEFAULT_NEW_ALIGNMENT__; }
};

}  // namespace

Memory& host_memory() {
  static HostMemory* const memory = new HostMemory;  // never destroyed: arrays of static duration use it at exit
  return *memory;
}

void detail::fail_array_size(size_t elements) {
  throw std::length_error("an array of " + std::to_string(elements) +
                          " elements exceeds the limit of 4294967295; use a smaller image or scene");
}

}  // namespace relume
