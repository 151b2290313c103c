// A GPU that NVIDIA's driver controls. It executes the PTX of the library, and needs no software of NVIDIA's but the
// driver.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "frame/cuda/driver.h"
#include "frame/device.h"

namespace relume::cuda {

struct DeviceOptions {
  int index = 0;            ///< of the GPU among those of the driver
  size_t memory_bytes = 0;  ///< limit of the total of all blocks; 0: what the GPU has free
};

/// Opens a GPU for the PTX of kernels (frame/cuda/device_entry.h). The driver compiles it, and keeps the result on disk
/// for later processes. `driver` must outlive the device. Throws Error if there is no such GPU, or if it cannot be
/// used.
std::unique_ptr<Device> open_device(const Driver& driver, const std::string& ptx, const DeviceOptions& options = {});

}  // namespace relume::cuda
