// The kernels that kernels.cu names, compiled for the host: launched_kernels_test.py reads their full names out of the
// object file, which resolves aliases and default arguments.
#include <cstdint>

#define __global__ __attribute__((used))
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
