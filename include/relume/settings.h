// Settings by name, as on the command line: size, techniques and their parameters, stopping, display.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "relume/export.h"
#include "relume/image.h"

namespace relume {

struct AllSettings;

struct Scene;

/// A declared setting.
struct SettingInfo {
  std::string name;           ///< in kebab case, with the technique's prefix: "psf.cell-size"
  std::string type;           ///< "integer from 0 to 1024", "one of path, bdpt"
  std::string default_value;  ///< in the form that set() accepts
  std::string help;
};

/// A value for every setting, initially its default. docs/settings.md lists them.
class RELUME_API Settings {
 public:
  Settings();
  ~Settings();
  Settings(const Settings& other);
  Settings(Settings&& other) noexcept;
  Settings& operator=(const Settings& other);
  Settings& operator=(Settings&& other) noexcept;

  /// Sets `name` to the value of `text`. Throws Error for unknown names (with the nearest one), values out of range and
  /// unknown choices. Returns *this.
  Settings& set(std::string_view name, std::string_view text);
  Settings& set(std::string_view name, const char* text) { return set(name, std::string_view(text)); }
  Settings& set(std::string_view name, bool value);
  Settings& set(std::string_view name, int value);
  Settings& set(std::string_view name, double value);

  /// The shortest text that set() maps to the same value. Throws Error for unknown names.
  std::string get(std::string_view name) const;

  /// Applies a preset such as "interactive"; other settings keep their values. Throws Error for unknown presets.
  Settings& apply_preset(std::string_view name);
  /// Applies a JSON object of names and values. `place` names its source in errors.
  Settings& apply_json(std::string_view json, std::string_view place);
  /// Whether sessions render all layers of Session::aov_names(), not only those that the techniques need. Initially
  /// not. Returns *this.
  Settings& provide_aovs(bool provided = true);
  /// Sessions render only these pixels, with the bits of the full image; others stay black. Empty: all. Returns *this.
  Settings& set_crop(const PixelWindow& window);
  /// All values, without layers and crop, as a JSON object.
  std::string to_json() const;

  /// All settings, in the order of docs/settings.md.
  static std::vector<SettingInfo> list();
  /// Names of the presets.
  static std::vector<std::string> presets();

 private:
  friend struct SettingsAccess;
  std::unique_ptr<AllSettings> values_;
};

/// Applies the settings that change a scene: env, env-rotation, env-exposure and variant. Throws Error (a missing file,
/// an unknown variant).
RELUME_API void apply_to_scene(const Settings& settings, Scene& scene);

}  // namespace relume
