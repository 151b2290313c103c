// A number that differs between scenes that render differently.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace relume {

/// Hash of everything in the scene that the image depends on (FNV-1a, 64 bits). Names do not count, but for cameras.
uint64_t scene_hash(const Scene& scene);

}  // namespace relume
