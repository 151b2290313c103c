// Launches the kernels that update a compiled scene. An interface, because `frame`, which launches kernels, depends on
// `scene`.
#pragma once

#include <cstdint>

#include "core/denormals.h"
#include "scene/deformation.h"

namespace relume {

/// Runs each kernel for x in [0, count) and y = 0. Kernels access the memory of the scene.
class SceneLauncher {
 public:
  virtual ~SceneLauncher() = default;
  virtual void run(const DeformVerticesKernel& kernel, uint32_t count) = 0;
  virtual void run(const StorePreviousPositionsKernel& kernel, uint32_t count) = 0;
};

/// Runs kernels on all cores, for scenes on memory of the host. Lives as long as the process.
SceneLauncher& host_scene_launcher(Denormals denormals);

}  // namespace relume
