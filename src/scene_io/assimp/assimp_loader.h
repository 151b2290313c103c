// Scene files through assimp.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// An FBX, DAE, STL, 3DS or OFF file. assimp reads more, but its rarer importers do not check their input. Throws
/// Error.
Scene load_assimp(const std::filesystem::path& file);

/// An OBJ file with its material libraries. Throws Error.
Scene load_obj(const std::filesystem::path& file);

/// As load_assimp() for the bytes of a file with `extension`; files beside it (materials, textures) are not found.
/// Throws Error.
Scene load_assimp_from_memory(std::span<const std::byte> file, const std::string& extension, const std::string& place);

}  // namespace relume
