#include "frame/cuda/cuda_device.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include <fmt/format.h>

#include "frame/cuda/devices.h"
#include "frame/cuda/launch_slots.h"
#include "frame/cuda/managed_memory.h"
#include "frame/cuda/memory_budget.h"
#include "frame/cuda/module.h"
#include "frame/cuda/queue.h"
#include "relume/error.h"

namespace relume::cuda {
namespace {

/// Left to the driver and to other programs, bytes.
constexpr size_t kSpareBytes = size_t{256} << 20;
/// Most blocks of a grid in y.
constexpr uint32_t kMaxGridHeight = 65535;

/// The threads of a block, for pass kernels. A warp has 32 consecutive threads: 8 × 4 pixels of an image, whose rays
/// are similar, or 32 elements of a list, which is a row or a column.
ElementBlock block_of(const Tile& window) {
  if (window.height() == 1) return {128, 1};
  if (window.width() == 1) return {1, 128};
  return {8, 16};
}

uint32_t blocks(uint32_t elements, uint32_t block) { return elements / block + (elements % block > 0 ? 1 : 0); }

/// The GPU, if relume can use it. Throws Error otherwise.
GpuInfo usable_gpu(const Driver& driver, int index) {
  GpuInfo gpu = gpu_info(driver, index);
  if (!gpu.problem.empty()) {
    throw Error(ErrorCode::device, fmt::format("{} (cuda:{}) cannot be used: {}", gpu.name, index, gpu.problem));
  }
  return gpu;
}

DeviceNumber number_of(const Driver& driver, int index) {
  DeviceNumber device = 0;
  check(driver, driver.cuDeviceGet(&device, index), fmt::format("opening GPU {}", index));
  return device;
}

class CudaDevice final : public Device {
 public:
  CudaDevice(const Driver& driver, const std::string& ptx, const DeviceOptions& options)
      : gpu_(usable_gpu(driver, options.index)),
        driver_version_(driver_version(driver)),
        queue_(driver, number_of(driver, gpu_.index), fmt::format("{} (cuda:{})", gpu_.name, gpu_.index)),
        module_(queue_, ptx),
        slots_(queue_),
        memory_(queue_, options.memory_bytes > 0 ? options.memory_bytes : std::numeric_limits<size_t>::max(),
                MemoryBudget::of_gpu(queue_.device(), gpu_.concurrent_access, queue_.device_name(),
                                     [this] { return free_bytes(); }),
                gpu_.concurrent_access) {}

  Memory& memory() override { return memory_; }
  uint32_t parallel_threads() const override {
    return static_cast<uint32_t>(std::max(1, gpu_.multiprocessors * gpu_.threads_per_multiprocessor));
  }
  ElementBlock block(const Tile& window) const override { return block_of(window); }
  void launch(const DeviceLaunch& launch) override;
  void wait(size_t launches) override;
  void finish() override;
  std::vector<double> take_times() override;
  double take_move_time() override { return slots_.take_move_time(); }
  std::optional<DeviceStatistics> statistics() const override;

 private:
  /// Memory of the GPU that blocks may take, with room left for the stacks of all threads.
  size_t free_bytes();
  const Kernel& kernel_of(const DeviceLaunch& launch) const;
  void copy_argument(const DeviceLaunch& launch, const LaunchSlot& slot);
  void run(const DeviceLaunch& launch, const Kernel& kernel);
  void record(Event event);

  GpuInfo gpu_;
  std::string driver_version_;
  Queue queue_;
  LoadedModule module_;
  LaunchSlots slots_;
  ManagedMemory memory_;
  std::vector<std::byte> last_argument_;  ///< in the device's constant, once the queued copies have ended
};

size_t CudaDevice::free_bytes() {
  const Queue::Current current(queue_);
  size_t free = 0;
  size_t total = 0;
  queue_.check(queue_.driver().cuMemGetInfo(&free, &total), "asking for the free memory");
  const size_t kept = kSpareBytes + module_.stack_bytes() * parallel_threads();
  return free > kept ? free - kept : 0;
}

const Kernel& CudaDevice::kernel_of(const DeviceLaunch& launch) const {
  const Kernel& kernel = module_.kernel(launch.kernel);
  if (kernel.is_group != (launch.threads > 0)) {
    throw Error(ErrorCode::device, fmt::format("the device code has the kernel {} as a {}; correct its line in the "
                                               "kernels.inc of its folder",
                                               launch.kernel, kernel.is_group ? "group kernel" : "pass kernel"));
  }
  if (launch.argument.size() > std::min(kArgumentBytes, module_.argument_bytes())) {
    throw Error(ErrorCode::device, fmt::format("the kernel {} has {} bytes, but device code takes {}", launch.kernel,
                                               launch.argument.size(), module_.argument_bytes()));
  }
  return kernel;
}

void CudaDevice::launch(const DeviceLaunch& launch) {
  const Queue::Current current(queue_);
  const Kernel& kernel = kernel_of(launch);
  LaunchSlot& slot = slots_.free_slot();
  try {
    slot.has_moves = memory_.has_moves();
    if (slot.has_moves) record(slot.moves);
    memory_.move_to_device();
    record(slot.begin);
    copy_argument(launch, slot);
    run(launch, kernel);
    record(slot.end);
  } catch (...) {
    // The copy of the argument may be queued.
    queue_.driver().cuStreamSynchronize(queue_.stream());
    last_argument_.clear();
    throw;
  }
  slots_.add(launch.name);
}

void CudaDevice::record(Event event) {
  queue_.check(queue_.driver().cuEventRecord(event, queue_.stream()), "recording an event");
}

void CudaDevice::copy_argument(const DeviceLaunch& launch, const LaunchSlot& slot) {
  const std::span<const std::byte> argument = launch.argument;
  if (std::equal(argument.begin(), argument.end(), last_argument_.begin(), last_argument_.end())) return;
  last_argument_.assign(argument.begin(), argument.end());
  if (argument.empty()) return;
  std::memcpy(slot.argument, argument.data(), argument.size());
  queue_.check(queue_.driver().cuMemcpyHtoDAsync(module_.argument(), slot.argument, argument.size(), queue_.stream()),
               "copying the argument of a kernel");
}

void CudaDevice::run(const DeviceLaunch& launch, const Kernel& kernel) {
  const ElementBlock block = kernel.is_group ? ElementBlock{} : block_of(launch.window);
  const uint32_t rows = kMaxGridHeight * block.height;
  Tile part = launch.window;
  for (; part.y0 < launch.window.y1; part.y0 = part.y1) {
    part.y1 = launch.window.y1 - part.y0 > rows ? part.y0 + rows : launch.window.y1;
    std::array<void*, 4> parameters{&part.x0, &part.y0, &part.x1, &part.y1};  // groups have the first two
    const uint32_t threads = kernel.is_group ? launch.threads : block.width;
    const Result result = queue_.driver().cuLaunchKernel(kernel.function, blocks(part.width(), block.width),
                                                         blocks(part.height(), block.height), 1, threads, block.height,
                                                         1, 0, queue_.stream(), parameters.data(), nullptr);
    if (result != Result::success) queue_.check(result, fmt::format("launching '{}'", launch.name));
  }
}

void CudaDevice::wait(size_t launches) {
  const Queue::Current current(queue_);
  slots_.wait(launches);
}

void CudaDevice::finish() {
  const Queue::Current current(queue_);
  try {
    queue_.finish();
    slots_.wait(0);
    memory_.free_blocks();
  } catch (...) {
    slots_.clear();
    throw;
  }
}

std::vector<double> CudaDevice::take_times() {
  const Queue::Current current(queue_);
  return slots_.take_times();
}

std::optional<DeviceStatistics> CudaDevice::statistics() const {
  return DeviceStatistics{.name = queue_.device_name(),
                          .driver = driver_version_,
                          .memory_bytes = gpu_.memory_bytes,
                          .memory_limit_bytes = memory_.budget().limit_bytes(),
                          .memory_used_bytes = memory_.budget().used_bytes()};
}

}  // namespace

std::unique_ptr<Device> open_device(const Driver& driver, const std::string& ptx, const DeviceOptions& options) {
  if (ptx.empty()) {
    throw Error(ErrorCode::device,
                "this build of relume has no device code; build it with clang and RELUME_CUDA=ON, or use --device cpu");
  }
  return std::make_unique<CudaDevice>(driver, ptx, options);
}

}  // namespace relume::cuda
