// Settings to and from JSON: one object whose keys are the settings' names. A name's dots may also be written as nested
// objects: {"path.russian-roulette": false} and {"path": {"russian-roulette": false}} say the same.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "settings/setting.h"

namespace relume {

/// All settings with dotted names, in the order of `list`, indented by two spaces. Reading it gives equal values.
std::string settings_to_json(const SettingList& list);

/// Sets those settings that the object names; comments (// and /* */) are allowed. Throws Error with `place` (a file
/// name) for text that is not JSON (with its line and column), unknown or repeated names and values that do not fit;
/// then no setting is changed.
void settings_from_json(const SettingList& list, std::string_view json, std::string_view place);

/// settings_from_json() of a file's text. Throws Error if the file cannot be read.
void settings_from_file(const SettingList& list, const std::filesystem::path& file);

}  // namespace relume
