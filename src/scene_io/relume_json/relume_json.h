// relume's own scene format (docs/scene-json.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// A .json file and the scene to which it refers. Throws Error.
Scene load_relume_json(const std::filesystem::path& file);

/// As load_relume_json() for the bytes of a file; paths in it are relative to `base_dir`. Throws Error.
Scene load_relume_json_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                                   const std::string& place);

}  // namespace relume
