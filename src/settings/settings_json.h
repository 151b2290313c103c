// Settings to and from JSON: one object with the settings' names as keys. Dots in a name may also be written as nested
// objects: {"path.russian-roulette": false} and {"path": {"russian-roulette": false}} are equivalent.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "settings/setting.h"

namespace relume {

/// All settings with dotted names, in the order of `list`, indented by two spaces. Reading the result gives equal
/// values.
std::string settings_to_json(const SettingList& list);

/// Sets the settings that the object names; comments (// and /* */) are allowed. Throws Error with `place` (a file
/// name) for invalid JSON (with line and column), unknown or repeated names and invalid values. No setting changes
/// then.
void settings_from_json(const SettingList& list, std::string_view json, std::string_view place);

/// Applies settings_from_json() to a file's text. Throws Error if the file cannot be read.
void settings_from_file(const SettingList& list, const std::filesystem::path& file);

}  // namespace relume
