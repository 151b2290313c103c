// Launches of kernels for tests of devices.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "frame/device.h"
#include "frame/kernel_names.h"
#include "frame/launch.h"

namespace relume::cuda::testing {

/// Queues a kernel on a device. `may_wait`: as for DeviceLaunch.
template <typename Kernel>
void queue(Device& device, const Kernel& kernel, const Tile& window, std::string_view name = "test",
           bool may_wait = false) {
  Kernel argument = kernel;
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&argument);
#endif
  uint32_t threads = 0;
  if constexpr (GroupKernel<Kernel>) threads = Kernel::kThreads;
  device.launch({name, kernel_type_name<Kernel>(), threads, std::as_bytes(std::span(&argument, 1)), window, may_wait});
}

/// Queues a kernel that the device may keep.
template <typename Kernel>
void queue_waiting(Device& device, const Kernel& kernel, const Tile& window, std::string_view name = "test") {
  queue(device, kernel, window, name, true);
}

}  // namespace relume::cuda::testing
