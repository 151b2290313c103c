#include "core/array.h"

#include <new>
#include <stdexcept>
#include <string>

namespace relume {
namespace {

class HostMemory final : public Memory {
 public:
  void* allocate(size_t bytes, size_t alignment) override {
    return is_default(alignment) ? ::operator new(bytes) : ::operator new(bytes, std::align_val_t(alignment));
  }
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override {
    if (is_default(alignment)) {
      ::operator delete(block, bytes);
    } else {
      ::operator delete(block, bytes, std::align_val_t(alignment));
    }
  }

 private:
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
