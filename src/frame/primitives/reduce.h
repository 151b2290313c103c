// Reductions: sums, minima, maxima of all elements. The order of operations depends on nothing but the number of
// elements, so that sums of real numbers have the same bits for any number of threads and either form of kernels.
#pragma once

#include <limits>
#include <optional>
#include <stop_token>

#include "core/fixed_point.h"
#include "frame/primitives/fill.h"
#include "frame/primitives/primitive.h"

namespace relume {

/// Sum. Integers wrap at their size. Elements are converted to T before they are added.
template <typename T>
struct Sum {
  using Value = T;
  RELUME_HD static constexpr T identity() { return T{}; }
  RELUME_HD static constexpr T combine(T a, T b) { return a + b; }
};

/// Smallest element; without elements, the largest value of T, or infinity. NaN elements are ignored.
template <typename T>
struct Min {
  using Value = T;
  RELUME_HD static constexpr T identity() {
    return std::numeric_limits<T>::has_infinity ? std::numeric_limits<T>::infinity() : std::numeric_limits<T>::max();
  }
  RELUME_HD static constexpr T combine(T a, T b) { return b < a ? b : a; }
};

/// Largest element; without elements, the lowest value of T, or −infinity. NaN elements are ignored.
template <typename T>
struct Max {
  using Value = T;
  RELUME_HD static constexpr T identity() {
    return std::numeric_limits<T>::has_infinity ? -std::numeric_limits<T>::infinity()
                                                : std::numeric_limits<T>::lowest();
  }
  RELUME_HD static constexpr T combine(T a, T b) { return a < b ? b : a; }
};

/// Number of partial results per block. Element i of a block belongs to partial result i mod kReduceLanes: one per lane
/// of vector registers, or per thread of a device.
inline constexpr uint32_t kReduceLanes = 16;

/// Reduces blocks of kPrimitiveBlock elements; one call per block. Each lane combines its elements in ascending order.
/// Then the upper half of the lanes is combined with the lower half, until one is left.
template <typename Input, typename Operation>
struct ReduceKernel {
  using Value = typename Operation::Value;

  Input input;
  uint32_t elements = 0;
  View<Value> results;  ///< by block

  RELUME_HD void operator()(uint32_t index, uint32_t) const {
    const PrimitiveBlock block(index, elements);
    Value lanes[kReduceLanes];
    for (Value& lane : lanes) lane = Operation::identity();
    size_t i = block.begin;
    for (; i + kReduceLanes <= block.end; i += kReduceLanes) {
      for (uint32_t k = 0; k < kReduceLanes; ++k) lanes[k] = combine(lanes[k], i + k);
    }
    for (uint32_t k = 0; i < block.end; ++i, ++k) lanes[k] = combine(lanes[k], i);
    for (uint32_t half = kReduceLanes / 2; half > 0; half /= 2) {
      for (uint32_t k = 0; k < half; ++k) lanes[k] = Operation::combine(lanes[k], lanes[half + k]);
    }
    results[index] = lanes[0];
  }

 private:
  RELUME_HD Value combine(Value lane, size_t i) const { return Operation::combine(lane, static_cast<Value>(input(i))); }
};

/// Combines input(0) … input(size − 1) by Operation. Reduces blocks, then the blocks' results in the same way, until
/// one is left. Returns no value if `stop` was requested first.
template <typename Operation, typename Input>
std::optional<typename Operation::Value> reduce_or_stop(const PrimitiveLaunch& at, const Input& input, uint32_t size,
                                                        const std::stop_token& stop) {
  using Value = typename Operation::Value;
  if (size == 0) return Operation::identity();
  uint32_t needed = 0;
  for (uint32_t count = primitive_blocks(size);; count = primitive_blocks(count)) {
    needed += count;
    if (count == 1) break;
  }
  const View<Value> partials = at.scratch.partials<Value>(at.backend, needed);
  uint32_t first = 0;
  uint32_t count = primitive_blocks(size);
  const ReduceKernel<Input, Operation> elements{input, size, {partials.data, count}};
  if (!launch(at.backend, at.name, elements, count, 1, stop)) return std::nullopt;
  while (count > 1) {
    const uint32_t blocks = primitive_blocks(count);
    const ReduceKernel<Elements<Value>, Operation> level{
        {{partials.data + first, count}}, count, {partials.data + first + count, blocks}};
    if (!launch(at.backend, at.name, level, blocks, 1, stop)) return std::nullopt;
    first += count;
    count = blocks;
  }
  return at.scratch.read_partial<Value>(first);
}

/// The same, and ignores stop requests.
template <typename Operation, typename Input>
typename Operation::Value reduce(const PrimitiveLaunch& at, const Input& input, uint32_t size) {
  return *reduce_or_stop<Operation>(at, input, size, {});
}

/// Finds any element that is true, and skips all later blocks; one call per block.
template <typename Input>
struct AnyKernel {
  Input input;
  uint32_t elements = 0;
  View<uint64_t> found;  ///< one element

  RELUME_HD void operator()(uint32_t index, uint32_t) const {
    if (atomic_load(found.data) != 0) return;
    const PrimitiveBlock block(index, elements);
    for (size_t i = block.begin; i < block.end; ++i) {
      if (input(i)) return atomic_or(found.data, 1);
    }
  }
};

/// Whether input(i) is true for any i < size.
template <typename Input>
bool any_of(const PrimitiveLaunch& at, const Input& input, uint32_t size) {
  const View<uint64_t> found = at.scratch.partials<uint64_t>(at.backend, 1);
  fill(at.backend, at.name, found, uint64_t{0});
  launch(at.backend, at.name, AnyKernel<Input>{input, size, found}, primitive_blocks(size), 1);
  return at.scratch.read_partial<uint64_t>(0) != 0;
}

/// Exact sum of counts.
inline uint64_t sum(const PrimitiveLaunch& at, View<const uint32_t> values) {
  return reduce<Sum<uint64_t>>(at, Elements<uint32_t>{values}, values.size);
}

}  // namespace relume
