#include "device/emulated_device.h"

#include <cstring>
#include <utility>

#include <fmt/format.h>

#include "core/clock.h"
#include "core/parallel.h"
#include "frame/kernel_names.h"
#include "relume/error.h"
#include "runtime/block.h"
#include "runtime/launch.h"

namespace relume::testing {
namespace {

constexpr const char* kArgument = "relume_kernel";

/// Edges of a block of a pass kernel's threads. Images are rarely a multiple.
constexpr uint32_t kBlockWidth = 16;
constexpr uint32_t kBlockHeight = 4;

uint32_t blocks_for(uint32_t elements, uint32_t block) { return (elements + block - 1) / block; }

/// Opens memory for a launch.
class OpenWalls {
 public:
  OpenWalls(WalledMemory& walls, std::string_view launch) : walls_(walls) { walls_.begin_launch(launch); }
  ~OpenWalls() { walls_.end_launch(); }
  OpenWalls(const OpenWalls&) = delete;
  OpenWalls& operator=(const OpenWalls&) = delete;

 private:
  WalledMemory& walls_;
};

/// Blocks and threads for a window. `threads`: of a group, or 0.
ptx::Launch launch_of(const Tile& window, uint32_t threads) {
  ptx::Launch launch;
  if (threads > 0) {
    launch.grid = {window.width(), window.height()};
    launch.block = {threads};
    return launch;
  }
  const uint32_t width = window.height() == 1 ? kBlockWidth * kBlockHeight : kBlockWidth;
  launch.block = {width, kBlockWidth * kBlockHeight / width};
  launch.grid = {blocks_for(window.width(), launch.block.x), blocks_for(window.height(), launch.block.y)};
  return launch;
}

/// Runs the blocks of a launch in random order.
void run_blocks(const ptx::Module& module, const ptx::Entry& entry, const ptx::Launch& launch, Tile window) {
  void* const parameters[] = {&window.x0, &window.y0, &window.x1, &window.y1};
  ptx::Random random(launch.seed);
  const std::vector<uint32_t> order = ptx::shuffled_indices(launch.grid.x * launch.grid.y, random);
  parallel_for(order.size(), [&](size_t i) {
    const uint32_t index = order[i];
    ptx::run_block(module, entry, launch, parameters, {index % launch.grid.x, index / launch.grid.x, 0});
  });
}

}  // namespace

EmulatedDevice::EmulatedDevice(WalledMemory& walls, const std::vector<const ptx::Module*>& code, uint32_t seed)
    : walls_(walls), seed_(uint64_t{seed} << 32) {
  for (const ptx::Module* module : code) {
    for (const ptx::Entry& entry : module->entries) {
      const std::optional<EntryKernel> kernel = kernel_of_entry(entry.name);
      if (kernel) (kernel->is_group ? group_kernels_ : pass_kernels_).try_emplace(kernel->type, Code{module, &entry});
    }
  }
}

EmulatedDevice::~EmulatedDevice() = default;

void EmulatedDevice::launch(const DeviceLaunch& launch) {
  const std::lock_guard lock(mutex_);
  const Codes& codes = launch.threads > 0 ? group_kernels_ : pass_kernels_;
  const auto code = codes.find(launch.kernel);
  if (code == codes.end())
    throw Error(
        fmt::format("launch '{}': the device code has no entry for the kernel {}; add the kernel to the "
                    "kernels.inc of its folder",
                    launch.name, launch.kernel));
  const size_t limit = code->second.module->symbol(kArgument).bytes;
  if (launch.argument.size() > limit)
    throw Error(
        fmt::format("launch '{}': the kernel {} has {} bytes, but device code takes {}; reduce the members of the "
                    "kernel",
                    launch.name, launch.kernel, launch.argument.size(), limit));
  ++launch_count_;
  queue_.push_back({std::string(launch.name), code->first, code->second, launch.threads,
                    std::vector<std::byte>(launch.argument.begin(), launch.argument.end()), launch.window});
}

void EmulatedDevice::wait(size_t launches) {
  const std::lock_guard lock(mutex_);
  try {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    while (queue_.size() > launches) run_oldest();
  } catch (...) {
    queue_.clear();
    times_.clear();
    throw;
  }
}

std::vector<double> EmulatedDevice::take_times() {
  const std::lock_guard lock(mutex_);
  return std::exchange(times_, {});
}

void EmulatedDevice::run_oldest() {
  const Queued queued = std::move(queue_.front());
  queue_.pop_front();
  static std::mutex module_mutex;  // a module has one kernel argument
  const std::lock_guard lock(module_mutex);
  const ptx::Symbol& argument = queued.code.module->symbol(kArgument);
  std::memset(argument.address, 0xff, argument.bytes);
  std::memcpy(argument.address, queued.argument.data(), queued.argument.size());
  ptx::Launch launch = launch_of(queued.window, queued.threads);
  launch.seed = ++seed_;
  const double start_s = now_s();
  try {
    const OpenWalls open(walls_, queued.name);
    run_blocks(*queued.code.module, *queued.code.entry, launch, queued.window);
  } catch (const ptx::Fault& fault) {
    throw Error(
        fmt::format("launch '{}': the kernel {} failed on the device: {}", queued.name, queued.kernel, fault.what()));
  }
  times_.push_back(now_s() - start_s);
}

void EmulatedDevice::WaitingMemory::deallocate(void* block, size_t bytes, size_t alignment) noexcept {
  const std::lock_guard lock(device_.mutex_);
  try {
    device_.finish();
  } catch (...) {
    device_.failure_ = std::current_exception();
  }
  device_.walls_.deallocate(block, bytes, alignment);
}

void EmulatedDevice::WaitingMemory::open_for_reading(const void* block) {
  device_.finish();
  device_.walls_.open_for_reading(block);
}

void EmulatedDevice::WaitingMemory::open_for_writing(void* block) {
  device_.finish();
  device_.walls_.open_for_writing(block);
}

}  // namespace relume::testing
