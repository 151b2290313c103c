// Hash that differs between scenes with different images.
#pragma once

#include <cstdint>

#include "scene/scene.h"

namespace relume {

/// Hash of all parts of the scene that affect the image (FNV-1a, 64 bits). Of names, only those of cameras count.
uint64_t scene_hash(const Scene& scene);

}  // namespace relume
