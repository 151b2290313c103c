// Compiles the kernels of kernels.cu for the host. check_launched_kernels.py reads their full names from the object
// file, where aliases and default arguments are resolved.
#include <cstdint>

#define __global__ __attribute__((used))
#define __shared__ static
#define __launch_bounds__(threads)
namespace {
struct Index {
  uint32_t x = 0;
  uint32_t y = 0;
};
constexpr Index blockIdx;
constexpr Index blockDim;
constexpr Index threadIdx;
}  // namespace

#include "kernels.cu"
