// The reference page of all settings, made from their declarations.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "settings/setting.h"

namespace relume {

/// Groups that interfaces show in a way of their own.
enum class SettingGroupRole { ordinary, image, stopping, slots };

/// Settings that are shown together.
struct SettingGroup {
  std::string_view title;
  std::string_view summary;  ///< one or two sentences
  SettingList settings;
  SettingGroupRole role = SettingGroupRole::ordinary;
};

/// All settings, group by group.
SettingList flatten(const std::vector<SettingGroup>& groups);

/// Markdown: a heading and a table for each group, with flag, value (type, unit, range), the value that the setting has
/// now (its default, in a freshly made object), whether a change resets the history, whether it biases, and its help.
std::string settings_to_markdown(const std::vector<SettingGroup>& groups);

}  // namespace relume
