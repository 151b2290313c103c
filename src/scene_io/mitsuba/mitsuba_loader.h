// Loads scenes of Mitsuba 3.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "scene/scene.h"

namespace relume {

/// Loads a .xml file and the files that it references in its folder. Throws Error.
Scene load_mitsuba(const std::filesystem::path& file);

/// Loads the bytes of a file, as load_mitsuba() does; its references are relative to `base_dir`. Throws Error.
Scene load_mitsuba_from_memory(std::span<const std::byte> file, const std::filesystem::path& base_dir,
                               const std::string& place);

}  // namespace relume
