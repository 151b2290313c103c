// Reads checks.json of every technique: the data that tests of all techniques need.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace relume::support {

/// Settings whose bits must not depend on threads and resumes.
struct DeterminismCheck {
  std::string name;
  std::string json;            ///< difference from small_settings()
  int frames_of_an_image = 3;  ///< between moves
};

/// Motion during the test of a setting.
enum class CheckMotion { none, camera, lamp };

/// Context in which a setting has an effect.
struct SettingCheck {
  /// A setting's name, or a prefix that ends in a dot. A setting's own check adds its changes to those of the prefix.
  std::string setting;
  std::string with = {};    ///< changes from small_settings(): "name=value name=value"
  std::string others = {};  ///< values for comparison; empty: derived from the setting
  CheckMotion motion = CheckMotion::none;
  std::string buffer = {};  ///< compared buffer; empty: the image
};

struct TechniqueChecks {
  /// Largest relative change of the mean in the combination test's small box by "slot=choice", or by another setting's
  /// "name=value".
  std::map<std::string, double, std::less<>> biases;
  std::vector<DeterminismCheck> determinism;
  std::vector<SettingCheck> settings;  ///< prefixes precede their settings
};

/// Checks of all techniques. Throws std::runtime_error with the file's name if one cannot be read.
const TechniqueChecks& technique_checks();

}  // namespace relume::support
