#include "cli/machine.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/platform.h"
#include "cli/version.h"
#include "frame/cuda/device_choice.h"
#include "frame/cuda/devices.h"

namespace relume::cli {
namespace {

/// The GPU that a value of --device names, or "processor".
std::string device_name(const std::string& value) {
  const std::string resolved = cuda::resolved_device(value);
  const cuda::DeviceChoice choice = cuda::parse_device(resolved);
  if (choice.kind == cuda::DeviceChoice::Kind::host) return "processor";
  const cuda::GpuList list = cuda::list_gpus();
  for (const cuda::GpuInfo& gpu : list.gpus) {
    if (gpu.index == choice.index)
      return fmt::format("{} (cuda:{}), driver for CUDA {}", gpu.name, gpu.index, list.driver_version);
  }
  return resolved;
}

/// Each device once, separated by commas.
std::string device_names(const std::vector<std::string>& values) {
  std::vector<std::string> names;
  for (const std::string& value : values) {
    std::string name = device_name(value);
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(std::move(name));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> machine_description(const std::vector<std::string>& devices) {
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  return {{"Processor", fmt::format("{}, {} hardware threads", processor_name(), std::thread::hardware_concurrency())},
          {"Device", device_names(devices)},
          {"Program", kVersionLine},
          {"Date", fmt::format("{:%Y-%m-%d %H:%M} UTC", fmt::gmtime(std::chrono::system_clock::to_time_t(now)))}};
}

}  // namespace relume::cli
