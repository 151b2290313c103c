// Loads relume's own scene format (docs/scene-json.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Loads a .json file and the scene that it references. Throws Error.
Scene load_relume_json(const std::filesystem::path& file);

/// Loads the bytes of a file, as load_relume_json() does; its paths are relative to `base_dir`. Throws Error.
Scene load_relume_json_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                                   const std::string& place);

}  // namespace relume
