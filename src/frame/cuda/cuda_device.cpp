#include "frame/cuda/cuda_device.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "frame/cuda/devices.h"
#include "frame/cuda/display.h"
#include "frame/cuda/kernel_call.h"
#include "frame/cuda/launch_graphs.h"
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
        graphs_(queue_, slots_, module_.argument(), options.graphs),
        memory_(queue_, options.memory_bytes > 0 ? options.memory_bytes : std::numeric_limits<size_t>::max(),
                MemoryBudget::of_gpu(queue_.device(), gpu_.concurrent_access, queue_.device_name(),
                                     [this] { return free_bytes(); }),
                gpu_.concurrent_access) {
    queue_.on_submit([this] {
      const std::lock_guard lock(mutex_);
      submit();
    });
  }

  Memory& memory() override { return memory_; }
  uint32_t parallel_threads() const override {
    return static_cast<uint32_t>(std::max(1, gpu_.multiprocessors * gpu_.threads_per_multiprocessor));
  }
  ElementBlock block(const Tile& window) const override { return block_of(window); }
  void launch(const DeviceLaunch& launch) override;
  void wait(size_t launches) override;
  void finish() override;
  std::vector<double> take_times() override;
  double take_move_time() override {
    const std::lock_guard lock(mutex_);
    return slots_.take_move_time();
  }
  std::optional<DeviceStatistics> statistics() const override;
  std::shared_ptr<DeviceImage> copy_image(const void* pixels, size_t bytes) override;

 private:
  /// Memory of the GPU that blocks may take, with room left for the stacks of all threads.
  size_t free_bytes();
  const Kernel& kernel_of(const DeviceLaunch& launch) const;
  // The functions below need the mutex.
  /// Gives the launches that it keeps to the driver. Drops the rest after an error, which it throws.
  void submit();
  void submit_calls(std::span<const KernelCall> calls);
  void submit_call(const KernelCall& call);
  /// Returns false if they are to be launched one by one.
  bool submit_graph(std::span<const KernelCall> calls);
  /// Queues the work that precedes the launches of a slot.
  void begin(LaunchSlot& slot);
  void copy_argument(const KernelCall& call, const LaunchSlot& slot);
  void record(Event event);

  GpuInfo gpu_;
  std::string driver_version_;
  Queue queue_;
  LoadedModule module_;
  std::mutex mutex_;  ///< guards the launches, because any thread may submit them: slots_ and the members below
  LaunchSlots slots_;
  LaunchGraphs graphs_;
  std::vector<KernelCall> kept_;          ///< launches that the driver does not have yet
  std::vector<std::byte> last_argument_;  ///< in the device's constant, once the queued copies have ended
  ManagedMemory memory_;
  std::shared_ptr<Display> display_;  ///< nullptr until the first image for a window
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
  KernelCall call{.name = std::string(launch.name),
                  .kernel = &kernel_of(launch),
                  .group_threads = launch.threads,
                  .window = launch.window,
                  .argument = {launch.argument.begin(), launch.argument.end()}};
  const bool waits = launch.may_wait && is_one_grid(call);
  const std::lock_guard lock(mutex_);
  if (!waits) submit();
  queue_.added();
  if (!waits) return submit_calls(std::span(&call, 1));
  kept_.push_back(std::move(call));
  if (kept_.size() == LaunchGraphs::kMostLaunches) submit();
}

void CudaDevice::submit() {
  if (kept_.empty()) return;
  const std::vector<KernelCall> calls = std::exchange(kept_, {});
  const size_t before = slots_.launched();
  try {
    submit_calls(calls);
  } catch (...) {
    // Each launch that was accepted has a time.
    try {
      slots_.add_dropped(before + calls.size() - slots_.launched());
    } catch (...) {  // the device is lost
    }
    throw;
  }
}

void CudaDevice::submit_calls(std::span<const KernelCall> calls) {
  try {
    if (submit_graph(calls)) return;
    for (const KernelCall& call : calls) submit_call(call);
  } catch (...) {
    // Copies of arguments may be queued.
    queue_.driver().cuStreamSynchronize(queue_.stream());
    last_argument_.clear();
    throw;
  }
}

void CudaDevice::submit_call(const KernelCall& call) {
  LaunchSlot& slot = slots_.free_slot();
  begin(slot);
  copy_argument(call, slot);
  const Result result = queue_kernel(queue_.driver(), queue_.stream(), call);
  if (result != Result::success) queue_.check(result, fmt::format("launching '{}'", call.name));
  record(slot.end);
  slots_.add(call.name);
}

bool CudaDevice::submit_graph(std::span<const KernelCall> calls) {
  LaunchGraph* const graph = graphs_.prepare(calls);
  if (!graph) return false;
  const Event end = slots_.free_slot(calls.size() - 1).end;
  begin(slots_.free_slot());
  if (!graphs_.accepts(queue_.driver().cuGraphLaunch(graph->execution, queue_.stream()))) return false;
  record(end);
  std::vector<std::string_view> names;
  for (const KernelCall& call : calls) names.push_back(call.name);
  slots_.add_graph(names, graph->ends);
  graphs_.launched(*graph);
  last_argument_ = calls.back().argument;
  return true;
}

void CudaDevice::begin(LaunchSlot& slot) {
  slot.has_moves = memory_.has_moves();
  if (slot.has_moves) record(slot.moves);
  memory_.move_to_device();
  record(slot.begin);
}

void CudaDevice::record(Event event) {
  queue_.check(queue_.driver().cuEventRecord(event, queue_.stream()), "recording an event");
}

void CudaDevice::copy_argument(const KernelCall& call, const LaunchSlot& slot) {
  if (call.argument == last_argument_) return;
  last_argument_ = call.argument;
  if (call.argument.empty()) return;
  std::memcpy(slot.argument, call.argument.data(), call.argument.size());
  queue_.check(
      queue_.driver().cuMemcpyHtoDAsync(module_.argument(), slot.argument, call.argument.size(), queue_.stream()),
      "copying the argument of a kernel");
}

void CudaDevice::wait(size_t launches) {
  const Queue::Current current(queue_);
  const std::lock_guard lock(mutex_);
  submit();
  slots_.wait(launches);
}

void CudaDevice::finish() {
  const Queue::Current current(queue_);
  try {
    queue_.finish();
    const std::lock_guard lock(mutex_);
    slots_.wait(0);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    // Work may be queued that reads the slots.
    queue_.driver().cuStreamSynchronize(queue_.stream());
    kept_.clear();
    slots_.clear();
    throw;
  }
  memory_.free_blocks();
}

std::vector<double> CudaDevice::take_times() {
  const Queue::Current current(queue_);
  const std::lock_guard lock(mutex_);
  return slots_.take_times();
}

std::shared_ptr<DeviceImage> CudaDevice::copy_image(const void* pixels, size_t bytes) {
  const Queue::Current current(queue_);
  // Without concurrent access, the host must access no memory while an image is copied.
  if (!gpu_.concurrent_access || bytes == 0) return nullptr;
  queue_.submit();  // an error of a launch is not one of the image
  try {
    if (!display_) {
      display_ = std::make_shared<Display>(queue_.driver(), queue_.device(), queue_.device_name(), memory_.budget());
    }
    return display_->copy(queue_, memory_, pixels, bytes);
  } catch (const Error&) {
    queue_.check_usable();
    return nullptr;
  } catch (const DeviceMemoryError&) {
    return nullptr;
  }
}

std::optional<DeviceStatistics> CudaDevice::statistics() const {
  return DeviceStatistics{.name = queue_.device_name(),
                          .driver = driver_version_,
                          .memory_bytes = gpu_.memory_bytes,
                          .memory_limit_bytes = memory_.budget()->limit_bytes(),
                          .memory_used_bytes = memory_.budget()->used_bytes()};
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
