// An emulated device: executes the device code of kernels on the processor, in memory that is closed to host code
// except after read() or write() of an array.
#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "frame/device.h"
#include "runtime/module.h"
#include "testing/walled_memory.h"

namespace relume::testing {

/// Queued launches run as late as possible: when the host waits for them, or accesses memory. So host code that does
/// not wait sees memory from before the launch, and host code that overwrites an input changes the results. The blocks
/// of a launch run in random order, on all cores. Launches of several devices run one after the other.
class EmulatedDevice final : public Device {
 public:
  /// `walls`: its memory. `code`: translations of device code, with entries for kernels (frame/cuda/device_entry.h);
  /// those of earlier modules replace those of later ones. All must outlive the device. `seed`: of the order of blocks
  /// and threads.
  EmulatedDevice(WalledMemory& walls, const std::vector<const ptx::Module*>& code, uint32_t seed = 0);
  ~EmulatedDevice() override;

  Memory& memory() override { return memory_; }
  /// Few, so that small images have several bands.
  uint32_t parallel_threads() const override { return 256; }
  void launch(const DeviceLaunch& launch) override;
  void wait(size_t launches) override;
  void finish() override { wait(0); }
  std::vector<double> take_times() override;

  /// Launches so far.
  size_t launches() const { return launch_count_; }

 private:
  /// Waits for the queue before the host accesses a block, or frees it.
  class WaitingMemory final : public Memory {
   public:
    explicit WaitingMemory(EmulatedDevice& device) : device_(device) {}
    void* allocate(size_t bytes, size_t alignment) override { return device_.walls_.allocate(bytes, alignment); }
    void deallocate(void* block, size_t bytes, size_t alignment) noexcept override;
    void open_for_reading(const void* block) override;
    void open_for_writing(void* block) override;

   private:
    EmulatedDevice& device_;
  };

  /// Code of a kernel.
  struct Code {
    const ptx::Module* module;
    const ptx::Entry* entry;
  };
  using Codes = std::map<std::string, Code, std::less<>>;  ///< by kernel_type_name()

  struct Queued {
    std::string name;
    std::string kernel;
    Code code;
    uint32_t threads;
    std::vector<std::byte> argument;
    Tile window;
  };

  void run_oldest();

  Codes pass_kernels_;
  Codes group_kernels_;
  WalledMemory& walls_;
  WaitingMemory memory_{*this};
  std::recursive_mutex mutex_;  ///< of the members below
  std::deque<Queued> queue_;
  std::vector<double> times_;
  std::exception_ptr failure_;  ///< of a launch that ran while memory was freed
  size_t launch_count_ = 0;
  uint64_t seed_;  ///< of the last launch that ran
};

}  // namespace relume::testing
