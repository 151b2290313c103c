#include <cstdio>
#include <string>
#include <thread>

#include <fmt/format.h>

#include "accel/embree_accel.h"
#include "cli/command.h"
#include "cli/platform.h"
#include "frame/cuda/device_code.h"
#include "frame/cuda/devices.h"

namespace relume::cli {
namespace {

/// The widest vector instructions that the processor supports and relume or Embree may use.
const char* vector_instructions() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return "AVX-512";
  if (__builtin_cpu_supports("avx2")) return "AVX2";
  if (__builtin_cpu_supports("avx")) return "AVX";
  return "SSE2";
#elif defined(__aarch64__)
  return "NEON";
#else
  return "unknown";
#endif
}

/// The driver and its GPUs, a line each.
std::string gpu_lines() {
  if (device_code().empty()) return "CUDA          no device code in this build; build it with clang\n";
  const cuda::GpuList list = cuda::list_gpus();
  std::string lines = list.problem.empty() ? fmt::format("CUDA          {}; relume has not been tested on a GPU yet\n",
                                                         list.driver_version)
                                           : fmt::format("CUDA          {}\n", list.problem);
  for (const cuda::GpuInfo& gpu : list.gpus) {
    lines += fmt::format("{:<14}{}, {:.1f} GiB, compute capability {}.{}{}\n", fmt::format("cuda:{}", gpu.index),
                         gpu.name, static_cast<double>(gpu.memory_bytes) / (1 << 30), gpu.capability_major,
                         gpu.capability_minor, gpu.problem.empty() ? "" : "; cannot be used: " + gpu.problem);
  }
  return lines;
}

int run_devices() {
  const std::string text = fmt::format(
      "processor     {}\nthreads       {}\nvectors       {}\nray queries   Embree {}, or relume's own BVH (--accel "
      "bvh)\n{}",
      processor_name(), std::thread::hardware_concurrency(), vector_instructions(), EmbreeAccel::embree_version(),
      gpu_lines());
  std::fputs(text.c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command devices_command() {
  return {
      .name = "devices",
      .summary = "List the processor and the GPUs, and why a GPU cannot be used.",
      .examples = {{"relume devices", "processor, threads, vector instructions, ray queries, GPUs"}},
      .arguments = {},
      .options = {},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = run_devices,
  };
}

}  // namespace relume::cli
