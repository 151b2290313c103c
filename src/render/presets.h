// Named settings: --preset NAME.
#pragma once

#include <string_view>
#include <vector>

namespace relume {

struct Preset {
  std::string_view name;
  std::string_view summary;  ///< purpose in one line
  std::string_view json;     ///< settings for settings_from_json(); others keep their values
};

const std::vector<Preset>& presets();

/// Throws Error with the existing names if no preset has that name.
const Preset& require_preset(std::string_view name);

}  // namespace relume
