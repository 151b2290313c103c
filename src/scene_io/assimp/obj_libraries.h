// Files to which an OBJ file refers.
#pragma once

#include <filesystem>

namespace relume {

/// Records the material libraries that an OBJ file names near its beginning: assimp reads them past our functions.
void record_material_libraries(const std::filesystem::path& file);

}  // namespace relume
