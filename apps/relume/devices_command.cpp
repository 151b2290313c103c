#include <cstdio>
#include <thread>

#include <fmt/format.h>

#include "accel/embree_accel.h"
#include "command.h"
#include "platform.h"

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

int run_devices() {
  const std::string text = fmt::format(
      "processor     {}\nthreads       {}\nvectors       {}\nray queries   Embree {}, or relume's own BVH (--accel "
      "bvh)\nCUDA          not compiled in\n",
      processor_name(), std::thread::hardware_concurrency(), vector_instructions(), EmbreeAccel::embree_version());
  std::fputs(text.c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command devices_command() {
  return {
      .name = "devices",
      .summary = "List the devices that relume can use.",
      .examples = {{"relume devices", "processor, threads, vector instructions, ray queries"}},
      .arguments = {},
      .options = {},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = run_devices,
  };
}

}  // namespace relume::cli
