// Entries of kernels in device code. The build writes a source that includes this file and the kernels.inc of every
// folder.
#pragma once

#include <cstdint>

#include "frame/group.h"

namespace relume::device {

/// The kernel of a launch.
struct alignas(64) ArgumentBytes {
  unsigned char bytes[4096];
};

/// Written before each launch. As a parameter, the kernel would be copied to the stack of each thread.
extern "C" {
__constant__ ArgumentBytes relume_kernel;
}

/// The kernel as its type.
template <typename Kernel>
__device__ const Kernel& launched() {
  static_assert(sizeof(Kernel) <= sizeof(ArgumentBytes) && alignof(Kernel) <= alignof(ArgumentBytes));
  return *reinterpret_cast<const Kernel*>(&relume_kernel);
}

/// Calls a pass kernel for one element of a window that begins at (x0, y0) and ends before (x1, y1).
template <typename Kernel>
__global__ void run(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1) {
  // Within the window: positions of threads behind its end may exceed 32 bits.
  const uint32_t x = blockIdx.x * blockDim.x + threadIdx.x;
  const uint32_t y = blockIdx.y * blockDim.y + threadIdx.y;
  if (x < x1 - x0 && y < y1 - y0) launched<Kernel>()(x0 + x, y0 + y);
}

/// Calls a group kernel for one element, with a block of threads for each. The window begins at (x0, y0).
template <typename Kernel>
__global__ void __launch_bounds__(Kernel::kThreads) run_group(uint32_t x0, uint32_t y0) {
  __shared__ typename Kernel::Shared shared;
  launched<Kernel>()(ThreadGroup<Kernel::kThreads>{}, shared, x0 + blockIdx.x, y0 + blockIdx.y);
}

}  // namespace relume::device

/// Makes an entry for a pass kernel of the given type.
#define RELUME_KERNEL(...) \
  template __global__ void relume::device::run<__VA_ARGS__>(uint32_t, uint32_t, uint32_t, uint32_t)

/// The same for a group kernel.
#define RELUME_GROUP_KERNEL(...) template __global__ void relume::device::run_group<__VA_ARGS__>(uint32_t, uint32_t)
