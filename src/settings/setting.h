// Settings, each declared once. The declaration feeds command-line flags, JSON files, the viewer's widgets, the
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

#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace relume {

/// A setting with a closed list of named values; the enum's values count up from 0.
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

/// A number, or a word such as "auto" for std::nullopt.
struct OptionalNumberRef {
  std::optional<float>* value = nullptr;
  std::string_view word;
};

using SettingValue = std::variant<bool*, int*, float*, std::string*, ChoiceRef, OptionalNumberRef>;

struct SettingTraits {
  double min = -1e30;
  double max = 1e30;
  std::string_view unit = "";
  bool resets_history = true;  ///< whether a change invalidates accumulated frames
  bool biases = false;         ///< whether some values change the expected image; the help says how
};

struct Setting {
  std::string name;  ///< kebab-case, with the technique's prefix: "psf.cell-size"
  SettingValue value;
  std::string_view help;
  SettingTraits traits = {};
};

using SettingList = std::vector<Setting>;

/// A value without its setting. Choices, and words in place of numbers, are strings.
using SettingConstant = std::variant<bool, int, float, std::string>;

/// Prepends "prefix." to each name of `list`.
SettingList with_prefix(std::string_view prefix, SettingList list);

/// Returns nullptr if no setting has that name.
const Setting* find_setting(const SettingList& list, std::string_view name);

/// The setting with that name. Throws Error with `place` and the nearest name, or all names, if it does not exist.
const Setting& require_setting(const SettingList& list, std::string_view name, std::string_view place);

/// Parses `text` and checks it against type, range and choices. Booleans are true/false, on/off, yes/no or 1/0;
/// settings with the unit "s" also accept durations ("500ms", "2min"). Throws Error, for instance "`place`: max-bounces
/// is '-1', but must be from 0 to 1024" (without the colon if `place` is empty).
SettingConstant parse_value(const Setting& setting, std::string_view text, std::string_view place);

/// Stores the result of parse_value() in the setting's variable.
void assign(const Setting& setting, std::string_view text, std::string_view place);

/// Stores a value of the setting's type, unchecked.
void store(const Setting& setting, const SettingConstant& value);
SettingConstant load(const Setting& setting);

/// The shortest text that parse_value() maps to the same value.
std::string to_string(const Setting& setting);
std::string to_string(const SettingConstant& value);

/// Type for help and reference pages: "integer from 0 to 1024", "number in m, at least 0", "one of path, bdpt".
std::string describe_type(const Setting& setting);

/// Settings of `a` with different values in `b`, another list of the same type.
std::vector<const Setting*> differing_settings(const SettingList& a, const SettingList& b);

}  // namespace relume
