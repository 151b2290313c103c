// Reference page of all settings, generated from their declarations.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "settings/setting.h"

namespace relume {

/// Groups that interfaces display in a special way.
enum class SettingGroupRole { ordinary, image, stopping, slots };

/// A group of settings that are displayed together.
struct SettingGroup {
  std::string_view title;
  std::string_view summary;  ///< one or two sentences
  SettingList settings;
  SettingGroupRole role = SettingGroupRole::ordinary;
};

/// All settings, group by group.
SettingList flatten(const std::vector<SettingGroup>& groups);

/// Markdown with a heading and a table per group. Columns: flag, value (type, unit, range), current value (the default,
/// in a new object), reset of the history, bias, and help.
std::string settings_to_markdown(const std::vector<SettingGroup>& groups);

}  // namespace relume
