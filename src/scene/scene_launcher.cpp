#include "scene/scene_launcher.h"

#include <algorithm>

#include "core/flush_denormals.h"
#include "core/parallel.h"

namespace relume {
namespace {

class HostSceneLauncher final : public SceneLauncher {
 public:
  void run(const DeformVerticesKernel& kernel, uint32_t count) override { run_row(kernel, count); }
  void run(const StorePreviousPositionsKernel& kernel, uint32_t count) override { run_row(kernel, count); }

 private:
  template <typename Kernel>
  static void run_row(const Kernel& kernel, uint32_t count) {
    constexpr uint32_t kBlock = 1024;
    parallel_for(count / kBlock + 1, [&](uint32_t block) {
      const FlushDenormals guard;  // as in launches of a session
      const uint32_t begin = block * kBlock;
      const uint32_t end = begin + std::min(kBlock, count - begin);
      for (uint32_t x = begin; x < end; ++x) kernel(x, 0);
    });
  }
};

}  // namespace

SceneLauncher& host_scene_launcher() {
  static HostSceneLauncher launcher;
  return launcher;
}

}  // namespace relume
