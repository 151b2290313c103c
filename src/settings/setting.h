// A setting, declared once. The declaration feeds command-line flags, JSON files, the viewer's widgets, the
// reference page in docs/ and the metadata of every image.
//
// A technique describes its settings beside their defaults:
//
//   struct PathSettings {
//     int max_bounces = 8;
//   };
//   inline SettingList describe(PathSettings& s) {
//     return {{"max-bounces", &s.max_bounces, "Scattering events after the camera", {.min = 0, .max = 1024}}};
//   }
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace relume {

/// A setting whose value is one of a closed list of names; the enum's values count up from 0.
struct ChoiceRef {
  int* value = nullptr;
  std::vector<std::string_view> names;
};

/// Choice over an enum class whose underlying type is int.
template <typename Enum>
ChoiceRef choice(Enum& value, std::vector<std::string_view> names) {
  static_assert(sizeof(Enum) == sizeof(int), "enums in settings have the underlying type int");
  return {reinterpret_cast<int*>(&value), std::move(names)};
}

using SettingValue = std::variant<bool*, int*, float*, std::string*, ChoiceRef>;

struct SettingTraits {
  double min = -1e30;
  double max = 1e30;
  std::string_view unit = "";
  bool resets_history = true;  ///< a change makes what earlier frames accumulated invalid
  bool biases = false;         ///< some values change the expected image; the help says how
};

struct Setting {
  std::string name;  ///< kebab-case; a technique's settings carry its prefix: "psf.cell-size"
  SettingValue value;
  std::string_view help;
  SettingTraits traits = {};
};

using SettingList = std::vector<Setting>;

/// `list` with "prefix." before each name.
SettingList with_prefix(std::string_view prefix, SettingList list);

}  // namespace relume
