// relume's own scene format (docs/scene-json.md), from memory.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// As load_relume_json() for the bytes of a file; paths in it are relative to `base_dir`. Throws Error.
Scene load_relume_json_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                                   const std::string& place);

}  // namespace relume
