// Parts that the parallel primitives of this folder share (README.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "core/array.h"
#include "core/hd.h"
#include "core/view.h"
#include "frame/launch.h"

namespace relume {

/// Number of elements that one call of a primitive's kernel processes. A constant: the order of sums depends on it.
inline constexpr uint32_t kPrimitiveBlock = 2048;

RELUME_HD constexpr uint32_t primitive_blocks(uint32_t elements) {
  return elements / kPrimitiveBlock + (elements % kPrimitiveBlock > 0 ? 1 : 0);
}

/// Elements [begin, end) of block `index`. Loops over them only vectorise with indices of 64 bits, which do not wrap.
struct PrimitiveBlock {
  size_t begin = 0;
  size_t end = 0;

  RELUME_HD PrimitiveBlock(uint32_t index, size_t elements)
      : begin(size_t{index} * kPrimitiveBlock), end(begin + kPrimitiveBlock) {
    if (end > elements) end = elements;
  }
};

/// The elements of an array, as the input of a primitive. An input is plain data with `T operator()(size_t i) const`,
/// marked RELUME_HD; primitives may call it several times for an element.
template <typename T>
struct Elements {
  View<const T> values;

  RELUME_HD T operator()(size_t i) const { return values.data[i]; }
};

/// Temporary memory of primitives, on the memory of the backend that runs them. It grows to the largest need; callers
/// keep it between frames. One primitive at a time uses it.
class PrimitiveScratch {
 public:
  /// `count` elements without a value. Valid until the next call.
  template <typename T>
  View<T> partials(Backend& backend, uint32_t count) {
    static_assert(alignof(T) <= alignof(Word));
    const size_t words = (size_t{count} * sizeof(T) + sizeof(Word) - 1) / sizeof(Word);
    return {reinterpret_cast<T*>(grown(partials_, backend, words).data), count};
  }
  /// Element i of partials() for host code.
  template <typename T>
  T read_partial(uint32_t i) const {
    T value;
    std::memcpy(static_cast<void*>(&value), std::as_bytes(partials_.read()).data() + i * sizeof(T), sizeof(T));
    return value;
  }
  /// The same as partials(), for counts that other primitives must not overwrite.
  View<uint32_t> counts(Backend& backend, size_t count) { return grown(counts_, backend, count); }

  size_t memory_bytes() const { return partials_.memory_bytes() + counts_.memory_bytes(); }

 private:
  struct alignas(16) Word {
    std::byte bytes[16];
  };

  template <typename T>
  static View<T> grown(Array<T>& array, Backend& backend, size_t count) {
    if (&array.memory() != &backend.memory()) array = Array<T>(backend.memory());
    if (count > array.size()) array.reset(count, kUninitialized);
    return array.mutable_view();
  }

  Array<Word> partials_;
  Array<uint32_t> counts_;
};

/// Where a primitive runs, the name of its launches in timings, and its temporary memory.
struct PrimitiveLaunch {
  Backend& backend;
  std::string_view name;
  PrimitiveScratch& scratch;
};

}  // namespace relume
