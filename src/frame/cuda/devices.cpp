#include "frame/cuda/devices.h"

#include <array>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::cuda {
namespace {

/// Compute capability that the device code needs: that of its target, sm_75.
constexpr int kMinMajor = 7;
constexpr int kMinMinor = 5;

int attribute(const Driver& driver, DeviceNumber device, DeviceAttribute name) {
  int value = 0;
  check(driver, driver.cuDeviceGetAttribute(&value, name, device),
        fmt::format("asking a GPU for its attribute {}", static_cast<int>(name)));
  return value;
}

std::string problem_of(const Driver& driver, DeviceNumber device, const GpuInfo& gpu) {
  if (gpu.capability_major < kMinMajor || (gpu.capability_major == kMinMajor && gpu.capability_minor < kMinMinor)) {
    return fmt::format("its compute capability is {}.{}, but relume needs {}.{}; use another GPU or --device cpu",
                       gpu.capability_major, gpu.capability_minor, kMinMajor, kMinMinor);
  }
  if (attribute(driver, device, DeviceAttribute::managed_memory) == 0)
    return "it has no managed memory; use another GPU or --device cpu";
  if (attribute(driver, device, DeviceAttribute::compute_mode) == kComputeModeProhibited)
    return "its compute mode is 'prohibited'; change it with nvidia-smi --compute-mode=0";
  return "";
}

constexpr const char* kNoGpu =
    "the CUDA driver finds no GPU; check that nvidia-smi lists one and that CUDA_VISIBLE_DEVICES does not hide it, or "
    "use --device cpu";

int gpu_count(const Driver& driver) {
  if (!start(driver)) return 0;
  int count = 0;
  check(driver, driver.cuDeviceGetCount(&count), "counting the GPUs");
  return count;
}

/// As gpu_info(), with an error as the problem of the GPU.
GpuInfo info_or_problem(const Driver& driver, int index) {
  try {
    return gpu_info(driver, index);
  } catch (const Error& error) {
    GpuInfo unknown;
    unknown.index = index;
    unknown.name = "unknown GPU";
    unknown.problem = error.what();
    return unknown;
  }
}

}  // namespace

std::string driver_version(const Driver& driver) {
  int version = 0;
  check(driver, driver.cuDriverGetVersion(&version), "asking for the driver's version");
  return version_text(version);
}

GpuInfo gpu_info(const Driver& driver, int index) {
  const int count = gpu_count(driver);
  if (count == 0) throw Error(ErrorCode::device, kNoGpu);
  if (index < 0 || index >= count) {
    throw Error(ErrorCode::device, fmt::format("there is no GPU {}: the driver has {} (relume devices lists them); use "
                                               "--device cuda:N with a smaller N, or --device cpu",
                                               index, count));
  }
  DeviceNumber device = 0;
  check(driver, driver.cuDeviceGet(&device, index), fmt::format("opening GPU {}", index));
  std::array<char, 256> name{};
  check(driver, driver.cuDeviceGetName(name.data(), static_cast<int>(name.size()) - 1, device),
        fmt::format("asking GPU {} for its name", index));
  GpuInfo gpu;
  gpu.index = index;
  gpu.name = name.data();
  check(driver, driver.cuDeviceTotalMem(&gpu.memory_bytes, device),
        fmt::format("asking for the memory of {}", gpu.name));
  gpu.capability_major = attribute(driver, device, DeviceAttribute::compute_capability_major);
  gpu.capability_minor = attribute(driver, device, DeviceAttribute::compute_capability_minor);
  gpu.multiprocessors = attribute(driver, device, DeviceAttribute::multiprocessor_count);
  gpu.threads_per_multiprocessor = attribute(driver, device, DeviceAttribute::max_threads_per_multiprocessor);
  gpu.concurrent_access = attribute(driver, device, DeviceAttribute::concurrent_managed_access) != 0;
  gpu.problem = problem_of(driver, device, gpu);
  return gpu;
}

GpuList list_gpus() {
  GpuList list;
  try {
    const Driver& found = driver();
    list.driver_version = driver_version(found);
    const int count = gpu_count(found);
    for (int i = 0; i < count; ++i) list.gpus.push_back(info_or_problem(found, i));
    if (count == 0) list.problem = kNoGpu;
  } catch (const Error& error) {
    list.problem = error.what();
  }
  return list;
}

}  // namespace relume::cuda
