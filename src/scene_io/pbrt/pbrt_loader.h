// Loads scenes of pbrt-v4 [Pharr23].
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Loads a .pbrt or .pbrt.gz file and the files that it includes, which must lie in its folder. docs/formats.md
/// describes what becomes of materials and lights. Throws Error.
Scene load_pbrt(const std::filesystem::path& file);

/// Loads the bytes of a file; references are relative to `base_dir`, and `place` names the file in messages. Throws
/// Error.
Scene load_pbrt_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                            const std::string& place);

}  // namespace relume
