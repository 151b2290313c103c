// Public settings: access to the values by name.
#include <fmt/format.h>

#include "render/presets.h"
#include "render/settings.h"
#include "settings/settings_json.h"

namespace relume {

struct SettingsAccess {
  static const AllSettings& values(const Settings& settings) { return *settings.values_; }
  static Settings with(const RenderSettings& render) {
    Settings settings;
    settings.values_->render = render;
    return settings;
  }
};

const AllSettings& all_settings(const Settings& settings) { return SettingsAccess::values(settings); }

RenderSettings::operator Settings() const { return SettingsAccess::with(*this); }

Settings::Settings() : values_(std::make_unique<AllSettings>()) {}
Settings::~Settings() = default;
Settings::Settings(const Settings& other) : values_(std::make_unique<AllSettings>(*other.values_)) {}
Settings::Settings(Settings&& other) noexcept = default;
Settings& Settings::operator=(const Settings& other) {
  *values_ = *other.values_;
  return *this;
}
Settings& Settings::operator=(Settings&& other) noexcept = default;

Settings& Settings::set(std::string_view name, std::string_view text) {
  assign(require_setting(describe(*values_), name, ""), text, "");
  return *this;
}
Settings& Settings::set(std::string_view name, bool value) { return set(name, value ? "true" : "false"); }
Settings& Settings::set(std::string_view name, int value) { return set(name, fmt::format("{}", value)); }
Settings& Settings::set(std::string_view name, double value) { return set(name, fmt::format("{}", value)); }

std::string Settings::get(std::string_view name) const {
  return to_string(require_setting(describe(*values_), name, ""));
}

Settings& Settings::apply_preset(std::string_view name) { return apply_json(require_preset(name).json, name); }

Settings& Settings::apply_json(std::string_view json, std::string_view place) {
  settings_from_json(describe(*values_), json, place);
  return *this;
}

Settings& Settings::provide_aovs(bool provided) {
  values_->render.auxiliary = provided;
  return *this;
}

Settings& Settings::set_crop(const PixelWindow& window) {
  values_->render.crop = window;
  return *this;
}

std::string Settings::to_json() const { return settings_to_json(describe(*values_)); }

std::vector<SettingInfo> Settings::list() {
  AllSettings defaults;
  std::vector<SettingInfo> result;
  for (const Setting& setting : describe(defaults))
    result.push_back({setting.name, describe_type(setting), to_string(setting), std::string(setting.help)});
  return result;
}

std::vector<std::string> Settings::presets() {
  std::vector<std::string> names;
  for (const Preset& preset : relume::presets()) names.emplace_back(preset.name);
  return names;
}

}  // namespace relume
