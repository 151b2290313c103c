// The checks.json of every technique: what the tests of all techniques need to know of each.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace relume::support {

/// Settings for which the bits must not depend on threads and resumes.
struct DeterminismCheck {
  std::string name;
  std::string json;            ///< settings that differ from small_settings()
  int frames_of_an_image = 3;  ///< between moves
};

/// What moves while a setting is tested.
enum class CheckMotion { none, camera, lamp };

/// Where a setting takes effect.
struct SettingCheck {
  /// A name, or a prefix that ends in a dot. A setting's own check adds its changes to those of the prefix.
  std::string setting;
  std::string with = {};    ///< changes from small_settings(): "name=value name=value"
  std::string others = {};  ///< values to compare with; empty: derived from the setting
  CheckMotion motion = CheckMotion::none;
  std::string buffer = {};  ///< to compare; empty: the image
};

struct TechniqueChecks {
  /// "slot=choice": share by which the choice may change the mean of the combination test's small box.
  std::map<std::string, double, std::less<>> biases;
  std::vector<DeterminismCheck> determinism;
  std::vector<SettingCheck> settings;  ///< prefixes precede the settings that they are for
};

/// The checks of all techniques. Throws std::runtime_error, naming the file, for one that cannot be read.
const TechniqueChecks& technique_checks();

}  // namespace relume::support
