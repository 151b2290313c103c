// Finds the image files that scene files reference.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace relume {

/// Returns the image that a scene file in `base_dir` references by a path or a `file:` URI. Tries it as written, then
/// with slashes for backslashes, then its name beside the scene file and in "textures": paths may be from another
/// machine. If no file exists, returns the path as written, or throws Error as resolve_uri() does.
std::filesystem::path find_image(const std::filesystem::path& base_dir, std::string_view reference,
                                 const std::string& place);

/// The same for scene formats whose references stay in `base_dir`: of one that leaves it, by ".." or an absolute path,
/// only the name counts. Throws Error if no file of that name exists.
std::filesystem::path find_inside(const std::filesystem::path& base_dir, std::string_view reference,
                                  const std::string& place);

}  // namespace relume
