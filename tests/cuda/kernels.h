// Kernels for tests of the CUDA backend.
#pragma once

#include <cstdint>

#include "core/hd.h"
#include "core/view.h"

namespace relume::cuda::testing {

/// Adds a number to each element.
struct AddKernel {
  uint8_t step = 1;  // padding follows
  View<uint32_t> values;

  RELUME_HD void operator()(uint32_t x, uint32_t) const { values[x] += step; }
};

/// Appends a digit to each element: the result depends on the order of launches.
struct AppendKernel {
  View<uint64_t> values;
  uint64_t digit = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t) const { values[x] = values[x] * 31 + digit; }
};

/// Counts the elements of a window by the last six bits of their positions.
struct CountKernel {
  View<uint32_t> counts;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { ++counts[(x + y) % 64]; }
};

/// Writes its position to each element of an image.
struct PositionKernel {
  View<uint32_t> image;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { image[y * width + x] = y * 1000 + x; }
};

/// Sums up rows of 128 numbers.
struct RowSumKernel {
  static constexpr uint32_t kThreads = 64;
  struct Shared {
    uint32_t sums[kThreads];
  };

  View<const uint32_t> values;
  View<uint32_t> sums;

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t x, uint32_t y) const {
    group.each(kThreads, [&](uint32_t i) { shared.sums[i] = values[y * 128 + i] + values[y * 128 + 64 + i]; });
    for (uint32_t n = kThreads / 2; n > 0; n /= 2) {
      group.each(n, [&](uint32_t i) { shared.sums[i] += shared.sums[i + n]; });
    }
    group.each(1, [&](uint32_t) { sums[y] = shared.sums[0] + x; });
  }
};

/// Fails on a device.
struct TrapKernel {
  uint32_t unused = 0;

  RELUME_HD void operator()(uint32_t, uint32_t) const { __builtin_trap(); }
};

}  // namespace relume::cuda::testing
