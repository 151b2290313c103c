// Launches the kernels of a session's scene on its backend.
#pragma once

#include "frame/launch.h"
#include "scene/scene_launcher.h"

namespace relume {

class BackendSceneLauncher final : public SceneLauncher {
 public:
  explicit BackendSceneLauncher(Backend& backend) : backend_(backend) {}

  void run(const DeformVerticesKernel& kernel, uint32_t count) override { launch_row(kernel, count); }
  void run(const StorePreviousPositionsKernel& kernel, uint32_t count) override { launch_row(kernel, count); }

 private:
  template <typename Kernel>
  void launch_row(const Kernel& kernel, uint32_t count) {
    constexpr uint32_t kTile = 1024;
    launch(backend_, "deformation", kernel, count, 1, {}, kTile);
  }

  Backend& backend_;
};

}  // namespace relume
