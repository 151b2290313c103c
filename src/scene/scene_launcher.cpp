#include "scene/scene_launcher.h"

#include <algorithm>

#include "core/denormals.h"
#include "core/parallel.h"

namespace relume {
namespace {

class HostSceneLauncher final : public SceneLauncher {
 public:
  explicit HostSceneLauncher(Denormals denormals) : denormals_(denormals) {}

  void run(const DeformVerticesKernel& kernel, uint32_t count) override { run_row(kernel, count); }
  void run(const StorePreviousPositionsKernel& kernel, uint32_t count) override { run_row(kernel, count); }

 private:
  template <typename Kernel>
  void run_row(const Kernel& kernel, uint32_t count) const {
    constexpr uint32_t kBlock = 1024;
    parallel_for(count / kBlock + 1, [&](uint32_t block) {
      const DenormalMode mode(denormals_);
      const uint32_t begin = block * kBlock;
      const uint32_t end = begin + std::min(kBlock, count - begin);
      for (uint32_t x = begin; x < end; ++x) kernel(x, 0);
    });
  }

  Denormals denormals_;
};

}  // namespace

SceneLauncher& host_scene_launcher(Denormals denormals) {
  static HostSceneLauncher keeping(Denormals::keep);
  static HostSceneLauncher flushing(Denormals::flush);
  return denormals == Denormals::keep ? keeping : flushing;
}

}  // namespace relume
