#include "frame/cuda/device_choice.h"

#include <charconv>
#include <cstdlib>

#include <fmt/format.h>

#include "frame/cuda/cuda_device.h"
#include "frame/cuda/device_code.h"
#include "frame/cuda/devices.h"
#include "relume/error.h"

namespace relume::cuda {
namespace {

struct OpenedGpu {
  std::unique_ptr<Device> device;  ///< nullptr: none can be used
  int index = 0;
};

/// Options of a GPU. Throws Error for unknown values of the environment variable.
DeviceOptions options_of(int index) {
  constexpr const char* kGraphs = "RELUME_CUDA_GRAPHS";
  const char* const variable = std::getenv(kGraphs);
  const std::string_view value = variable ? variable : "1";
  if (value != "0" && value != "1") {
    throw Error(
        fmt::format("{} is '{}', but must be 0 (launches without CUDA graphs) or 1; unset it for 1", kGraphs, value));
  }
  return {.index = index, .graphs = value == "1"};
}

/// The first GPU that can be used.
OpenedGpu open_any() {
  if (device_code_bytes() == 0) return {};
  DeviceOptions options = options_of(0);
  const std::string code = device_code();
  for (const GpuInfo& gpu : list_gpus().gpus) {
    if (!gpu.problem.empty()) continue;
    options.index = gpu.index;
    try {
      return {open_device(driver(), code, options), gpu.index};
    } catch (const Error&) {
      continue;  // the next GPU, or the host, takes its place
    } catch (const DeviceMemoryError&) {
      continue;
    }
  }
  return {};
}

}  // namespace

DeviceChoice parse_device(std::string_view value) {
  constexpr std::string_view kIndexed = "cuda:";
  if (value == "cpu") return {};
  if (value == "auto") return {DeviceChoice::Kind::automatic};
  if (value == "cuda") return {DeviceChoice::Kind::gpu, 0};
  if (value.starts_with(kIndexed)) {
    const std::string_view digits = value.substr(kIndexed.size());
    int index = 0;
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), index);
    if (error == std::errc() && end == digits.end() && index >= 0) return {DeviceChoice::Kind::gpu, index};
  }
  throw Error(
      fmt::format("--device is '{}', but must be cpu, auto, cuda, or cuda:N with the number of a GPU (relume "
                  "devices lists them)",
                  value));
}

std::unique_ptr<Device> open_chosen_device(std::string_view value) {
  const DeviceChoice choice = parse_device(value);
  if (choice.kind == DeviceChoice::Kind::host) return nullptr;
  if (choice.kind == DeviceChoice::Kind::automatic) return open_any().device;
  return open_device(driver(), device_code(), options_of(choice.index));
}

std::string resolved_device(std::string_view value) {
  if (parse_device(value).kind != DeviceChoice::Kind::automatic) return std::string(value);
  const OpenedGpu gpu = open_any();
  return gpu.device ? fmt::format("cuda:{}", gpu.index) : "cpu";
}

}  // namespace relume::cuda
