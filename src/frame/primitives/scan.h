// Exclusive prefix sums of counts: the first place of each element's output, if outputs of various lengths follow each
// other.
#pragma once

#include <optional>
#include <stop_token>

#include "frame/primitives/reduce.h"

namespace relume {

/// Writes the prefix sums of blocks of kPrimitiveBlock elements; one call per block.
template <typename Input, typename T>
struct ScanKernel {
  Input input;
  uint32_t elements = 0;
  View<const uint64_t> bases;  ///< sum of all earlier blocks, by block; empty: one block
  View<T> sums;
  View<uint64_t> total;  ///< one element: sum of all elements

  RELUME_HD void operator()(uint32_t index, uint32_t) const {
    const PrimitiveBlock block(index, elements);
    uint64_t sum = bases.empty() ? 0 : bases[index];
    for (size_t i = block.begin; i < block.end; ++i) {
      const uint64_t value = input(i);
      sums.data[i] = static_cast<T>(sum);
      sum += value;
    }
    if (block.end == elements) total[0] = sum;
  }
};

namespace detail {

/// Scans `elements` > 0 elements. `memory`: for the total, then for the sums of blocks of all levels.
template <typename Input, typename T>
bool scan(const PrimitiveLaunch& at, const Input& input, uint32_t elements, View<T> sums, View<uint64_t> memory,
          uint32_t used, const std::stop_token& stop) {
  const uint32_t blocks = primitive_blocks(elements);
  const View<uint64_t> total{memory.data, 1};
  View<uint64_t> bases;
  if (blocks > 1) {
    bases = {memory.data + used, blocks};
    const ReduceKernel<Input, Sum<uint64_t>> block_sums{input, elements, bases};
    if (!launch(at.backend, at.name, block_sums, blocks, 1, stop)) return false;
    const Elements<uint64_t> level{{bases.data, blocks}};
    if (!scan(at, level, blocks, bases, memory, used + blocks, stop)) return false;
  }
  const ScanKernel<Input, T> kernel{input, elements, {bases.data, bases.size}, sums, total};
  return launch(at.backend, at.name, kernel, blocks, 1, stop);
}

}  // namespace detail

/// Writes sums[i] = input(0) + … + input(i − 1) for i < size, and returns the exact sum of all. `sums` may be the
/// memory that `input` reads, if input(i) reads only element i. Prefix sums wrap at 32 bits: callers whose total may be
/// larger check it. Returns no value if `stop` was requested first; `sums` is then incomplete.
template <typename Input>
std::optional<uint64_t> exclusive_scan_or_stop(const PrimitiveLaunch& at, const Input& input, View<uint32_t> sums,
                                               const std::stop_token& stop) {
  if (sums.empty()) return 0;
  uint32_t needed = 1;  // the total
  for (uint32_t count = primitive_blocks(sums.size); count > 1; count = primitive_blocks(count)) needed += count;
  const View<uint64_t> memory = at.scratch.partials<uint64_t>(at.backend, needed);
  if (!detail::scan(at, input, sums.size, sums, memory, 1, stop)) return std::nullopt;
  return at.scratch.read_partial<uint64_t>(0);
}

/// The same, and ignores stop requests.
template <typename Input>
uint64_t exclusive_scan(const PrimitiveLaunch& at, const Input& input, View<uint32_t> sums) {
  return *exclusive_scan_or_stop(at, input, sums, {});
}

/// Replaces counts by their prefix sums.
inline uint64_t exclusive_scan(const PrimitiveLaunch& at, View<uint32_t> counts) {
  return exclusive_scan(at, Elements<uint32_t>{{counts.data, counts.size}}, counts);
}

}  // namespace relume
