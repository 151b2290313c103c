#include "scene/scene_launcher.h"

#include "core/parallel.h"

namespace relume {
namespace {

class HostSceneLauncher final : public SceneLauncher {
 public:
  void run(const DeformVertices& kernel, uint32_t count) override {
    parallel_for(count, [&](uint32_t x) { kernel(x, 0); });
  }
  void run(const KeepPositions& kernel, uint32_t count) override {
    parallel_for(count, [&](uint32_t x) { kernel(x, 0); });
  }
};

}  // namespace

SceneLauncher& host_scene_launcher() {
  static HostSceneLauncher launcher;
  return launcher;
}

}  // namespace relume
