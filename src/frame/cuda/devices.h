// The GPUs of the system.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "frame/cuda/driver.h"

namespace relume::cuda {

/// A GPU, as the driver describes it.
struct GpuInfo {
  int index = 0;     ///< the N of --device cuda:N
  std::string name;  ///< such as "NVIDIA H100 80GB HBM3"
  size_t memory_bytes = 0;
  int capability_major = 0;  ///< compute capability, such as 9.0
  int capability_minor = 0;
  int multiprocessors = 0;
  int threads_per_multiprocessor = 0;  ///< that it executes at the same time
  bool concurrent_access = false;      ///< whether host and kernels may access managed memory at the same time
  std::string problem;                 ///< why relume cannot use it, and the remedy; empty if it can
};

/// Version of CUDA that the driver supports, such as "12.4". Throws Error.
std::string driver_version(const Driver& driver);

/// Describes a GPU. Throws Error if there is none with this index, with the number of GPUs.
GpuInfo gpu_info(const Driver& driver, int index);

/// The driver and its GPUs.
struct GpuList {
  std::string driver_version;  ///< as driver_version() writes it; empty without a driver
  std::string problem;         ///< why the list is empty, and the remedy; empty if it has a GPU
  std::vector<GpuInfo> gpus;
};

/// Lists the GPUs of the system. A GPU about which the driver says nothing has a problem.
GpuList list_gpus();

}  // namespace relume::cuda
