// The formats of scene files: a closed list from which loading, help, messages and the reference page follow.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

namespace relume {

struct SceneFormat {
  std::string_view name;                             ///< as help and messages show it
  std::vector<std::string_view> extensions;          ///< lower case, without the dot
  std::string_view signature;                        ///< first bytes of a file of any extension; empty: none
  Scene (*load)(const std::filesystem::path& file);  ///< reads a file that is not empty; throws Error
  std::string contents;                              ///< what the reader imports, as Markdown for the reference page
};

/// All formats, in the order of help and messages.
const std::vector<SceneFormat>& scene_formats();

/// The format whose signature begins the file, else the one with its extension. Throws Error if there is none.
const SceneFormat& scene_format_of(const std::filesystem::path& file);

/// The names in one phrase: "glTF, PLY or OFF".
std::string scene_format_names();

/// Text of docs/scene-formats.md.
std::string scene_formats_reference();

}  // namespace relume
