// Scene files through assimp, from memory.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// As load_assimp() for the bytes of a file with `extension`; files beside it (materials, textures) are not found.
/// Throws Error.
Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place);

}  // namespace relume
