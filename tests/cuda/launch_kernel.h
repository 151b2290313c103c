// Launches of kernels for tests of devices.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "frame/device.h"
#include "frame/kernel_names.h"
#include "frame/launch.h"

namespace relume::cuda::testing {

/// Queues a kernel on a device.
template <typename Kernel>
void queue(Device& device, const Kernel& kernel, const Tile& window, std::string_view name = "test") {
  Kernel argument = kernel;
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&argument);
#endif
  uint32_t threads = 0;
  if constexpr (GroupKernel<Kernel>) threads = Kernel::kThreads;
  device.launch({name, kernel_type_name<Kernel>(), threads, std::as_bytes(std::span(&argument, 1)), window});
}

}  // namespace relume::cuda::testing
