// Finds the files that an OBJ file references.
#pragma once

#include <filesystem>

namespace relume {

/// Records the material libraries that an OBJ file names in its first MiB: assimp opens them without record_read().
void record_material_libraries(const std::filesystem::path& file);

}  // namespace relume
