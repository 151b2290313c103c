#include "frame/cuda/kernel_call.h"

#include <array>

namespace relume::cuda {
namespace {

/// Most blocks of a grid in y.
constexpr uint32_t kMaxGridHeight = 65535;

uint32_t blocks(uint32_t elements, uint32_t block) { return elements / block + (elements % block > 0 ? 1 : 0); }

/// Elements that a block executes. A group executes one.
ElementBlock block_of_call(const KernelCall& call) {
  return call.kernel->is_group ? ElementBlock{} : block_of(call.window);
}

}  // namespace

ElementBlock block_of(const Tile& window) {
  if (window.height() == 1) return {128, 1};
  if (window.width() == 1) return {1, 128};
  return {8, 16};
}

bool is_one_grid(const KernelCall& call) {
  return blocks(call.window.height(), block_of_call(call).height) <= kMaxGridHeight;
}

Result queue_kernel(const Driver& driver, Stream stream, const KernelCall& call) {
  const ElementBlock block = block_of_call(call);
  const uint32_t rows = kMaxGridHeight * block.height;
  Tile part = call.window;
  for (; part.y0 < call.window.y1; part.y0 = part.y1) {
    part.y1 = call.window.y1 - part.y0 > rows ? part.y0 + rows : call.window.y1;
    std::array<void*, 4> parameters{&part.x0, &part.y0, &part.x1, &part.y1};  // groups have the first two
    const uint32_t threads = call.kernel->is_group ? call.group_threads : block.width;
    const Result result = driver.cuLaunchKernel(call.kernel->function, blocks(part.width(), block.width),
                                                blocks(part.height(), block.height), 1, threads, block.height, 1, 0,
                                                stream, parameters.data(), nullptr);
    if (result != Result::success) return result;
  }
  return Result::success;
}

}  // namespace relume::cuda
