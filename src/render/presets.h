// Named settings: --preset NAME.
#pragma once

#include <string_view>
#include <vector>

namespace relume {

struct Preset {
  std::string_view name;
  std::string_view summary;  ///< one line: what it is for
  std::string_view json;     ///< settings as settings_from_json() reads them; what is not named keeps its value
};

const std::vector<Preset>& presets();

/// Throws Error, with the names that exist, if there is none of that name.
const Preset& require_preset(std::string_view name);

}  // namespace relume
