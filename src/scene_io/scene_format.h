// Scene file formats: a closed list that drives loading, help, messages and the reference page.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

struct SceneFormat {
  std::string_view name;                             ///< display name in help and messages
  std::vector<std::string_view> extensions;          ///< lower case, without the dot
  std::string_view signature;                        ///< first bytes, for any extension; empty: none
  Scene (*load)(const std::filesystem::path& file);  ///< reads a nonempty file; throws Error
  std::string contents;                              ///< imported content, as Markdown for the reference page
};

/// All formats, in display order.
const std::vector<SceneFormat>& scene_formats();

/// Format whose signature starts the file, else the one with its extension. Throws Error if none matches.
const SceneFormat& scene_format_of(const std::filesystem::path& file);

/// Names as one phrase: "glTF, PLY or OFF".
std::string scene_format_names();

/// Text of docs/scene-formats.md.
std::string scene_formats_reference();

}  // namespace relume
