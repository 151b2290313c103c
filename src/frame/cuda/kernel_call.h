// A launch in the form that the driver takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "frame/cuda/module.h"
#include "frame/device.h"

namespace relume::cuda {

/// A launch, with copies of everything that it refers to.
struct KernelCall {
  std::string name;  ///< for messages
  const Kernel* kernel = nullptr;
  uint32_t group_threads = 0;  ///< for group kernels
  Tile window;
  std::vector<std::byte> argument;
};

/// Threads of a block, for pass kernels. A warp has 32 consecutive threads: 8 × 4 pixels of an image, whose rays are
/// similar, or 32 elements of a list, which is a row or a column.
ElementBlock block_of(const Tile& window);

/// Whether one call of the driver launches all elements: grids have a largest height.
bool is_one_grid(const KernelCall& call);

/// Queues the kernel in a stream. Its argument must be in the device's constant by then.
Result queue_kernel(const Driver& driver, Stream stream, const KernelCall& call);

}  // namespace relume::cuda
