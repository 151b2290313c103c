// Loads glTF files.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Loads a .gltf or .glb file. Throws Error.
Scene load_gltf(const std::filesystem::path& file);

/// Loads the bytes of a .gltf or .glb file. URIs are relative to `base_dir`; `place` names the file in messages. Throws
/// Error.
Scene load_gltf_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                            const std::string& place);

}  // namespace relume
