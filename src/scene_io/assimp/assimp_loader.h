// Loads scene files with assimp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Loads an OBJ, FBX, DAE, STL, 3DS or OFF file. Other importers of assimp are disabled because they do not check their
/// input. Throws Error.
Scene load_assimp(const std::filesystem::path& file);

/// Loads the bytes of a file with `extension`, as load_assimp() does. External materials and textures are not found.
/// Throws Error.
Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place);

}  // namespace relume
