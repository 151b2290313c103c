// A GPU that NVIDIA's driver controls. It executes the PTX of the library, and needs only NVIDIA's driver.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "frame/cuda/driver.h"
#include "frame/device.h"

namespace relume::cuda {

struct DeviceOptions {
  int index = 0;            ///< of the GPU among those of the driver
  size_t memory_bytes = 0;  ///< limit of the total of its blocks; 0: only that of all devices on the GPU
  bool graphs = true;       ///< whether sequences of launches that may wait become graphs (launch_graphs.h)
};

/// Opens a GPU for the PTX of kernels (frame/cuda/device_entry.h). The driver compiles it, and keeps the result on disk
/// for later processes. `driver` must outlive the device. All devices of the process on a GPU share the memory that was
/// free when the first was opened. Throws Error if there is no such GPU, if it cannot be used, or if another device
/// uses it and it has no concurrent access to managed memory.
std::unique_ptr<Device> open_device(const Driver& driver, const std::string& ptx, const DeviceOptions& options = {});

}  // namespace relume::cuda
