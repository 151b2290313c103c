#include "compare/contender.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "files/extension.h"
#include "relume/error.h"
#include "render/presets.h"
#include "settings/nearest_name.h"
#include "settings/text_list.h"

namespace relume {
namespace {

/// Settings of the comparison itself.
constexpr std::array<std::string_view, 16> kShared = {
    "width", "height",       "camera",       "scene-time", "shutter", "shutter-keys", "threads",  "scalar-kernels",
    "env",   "env-rotation", "env-exposure", "spp",        "time",    "exposure",     "tone-map", "error"};

bool is_shared(std::string_view name) { return std::find(kShared.begin(), kShared.end(), name) != kShared.end(); }

bool is_settings_file(std::string_view text) {
  const std::string extension = lower_extension(text);
  return extension == ".json" || extension == ".exr";
}

/// The only slot with `choice`; empty if there is none or several.
std::string slot_of(std::string_view choice) {
  RenderSettings settings;
  std::string slot;
  for (const Setting& setting : describe_slots(settings)) {
    const auto& names = std::get<ChoiceRef>(setting.value).names;
    if (std::find(names.begin(), names.end(), choice) == names.end()) continue;
    if (!slot.empty()) return {};
    slot = setting.name;
  }
  return slot;
}

bool is_preset(std::string_view name) {
  return std::any_of(presets().begin(), presets().end(), [&](const Preset& p) { return p.name == name; });
}

bool is_slot(std::string_view name) {
  RenderSettings settings;
  return find_setting(describe_slots(settings), name) != nullptr;
}

/// Whether the reference overrides the setting. Bounces are exempt: they change the compared light, not its
/// correctness.
bool belongs_to_reference(const Setting& setting) {
  return setting.name != "max-bounces" && (setting.traits.biases || is_slot(setting.name));
}

/// KEY:VALUE
std::pair<std::string, std::string> split_setting(std::string_view part, std::string_view place) {
  const size_t colon = std::min(part.find(':'), part.size());
  const std::string_view name = trimmed(part.substr(0, colon));
  const std::string_view value = trimmed(part.substr(std::min(colon + 1, part.size())));
  if (name.empty() || value.empty())
    throw Error(fmt::format("{}: '{}' is not KEY:VALUE, such as lights:vlc", place, part));
  return {std::string(name), std::string(value)};
}

/// Adds a setting, preset, technique or file to the contender.
void add_part(Contender& contender, std::string_view part, std::string_view place) {
  if (is_settings_file(part)) {
    contender.file = part;
  } else if (part.find(':') == std::string_view::npos) {
    if (part == "default") return;
    const std::string slot = is_preset(part) ? "" : slot_of(part);
    if (slot.empty()) {
      contender.preset = require_preset(part).name;
    } else {
      contender.settings.emplace_back(slot, part);
    }
  } else {
    contender.settings.push_back(split_setting(part, place));
  }
}

std::string own_name(std::string_view part) {
  return is_settings_file(part) ? std::filesystem::path(part).stem().string() : std::string(part);
}

template <typename T>
void check_names(const std::vector<T>& list, std::string_view place) {
  for (size_t i = 0; i < list.size(); ++i) {
    for (size_t k = 0; k < i; ++k) {
      if (list[i].name == list[k].name)
        throw Error(fmt::format("{}: two contenders are called '{}'; rename one with NAME=…", place, list[i].name));
    }
  }
}

/// Assigns additional settings of a contender or of the reference.
void assign_all(const SettingList& list, const SettingTexts& settings, const std::string& place) {
  for (const auto& [name, text] : settings) {
    if (is_shared(name))
      throw Error(fmt::format("{}: {} is common to all contenders; give it as --{}", place, name, name));
    assign(require_setting(list, name, place), text, place);
  }
}

/// Splits a part that begins a new contender into NAME and the rest.
std::pair<std::string, std::string_view> split_name(std::string_view part, std::string_view place) {
  const size_t equals = part.find('=');
  if (equals == std::string_view::npos) return {own_name(part), part};
  const std::string_view name = trimmed(part.substr(0, equals));
  const std::string_view rest = trimmed(part.substr(equals + 1));
  if (name.empty() || rest.empty())
    throw Error(fmt::format("{}: '{}' is not NAME=CONTENDER, such as fast=preview", place, part));
  return {std::string(name), rest};
}

}  // namespace

std::vector<Contender> parse_contenders(std::string_view text, std::string_view place) {
  std::vector<Contender> contenders;
  for (std::string_view part : split_at_commas(text)) {
    const bool continues =
        part.find('=') == std::string_view::npos && part.find(':') != std::string_view::npos && !is_settings_file(part);
    if (continues) {
      if (contenders.empty()) {
        throw Error(fmt::format("{}: '{}' needs a name before it, such as mine={}", place, part, part));
      }
      add_part(contenders.back(), part, place);
      continue;
    }
    const auto [name, rest] = split_name(part, place);
    contenders.push_back({.name = name});
    add_part(contenders.back(), rest, place);
  }
  if (contenders.empty())
    throw Error(fmt::format("{}: there is nothing to compare; name presets, files or settings", place));
  check_names(contenders, place);
  return contenders;
}

SettingTexts parse_settings(std::string_view text, std::string_view place) {
  SettingTexts settings;
  for (std::string_view part : split_at_commas(text)) settings.push_back(split_setting(part, place));
  return settings;
}

std::vector<ImageContender> parse_image_contenders(std::string_view text, std::string_view place) {
  std::vector<ImageContender> images;
  for (std::string_view part : split_at_commas(text)) {
    const auto [name, file] = split_name(part, place);
    images.push_back({part.find('=') == std::string_view::npos ? std::filesystem::path(file).stem().string() : name,
                      std::filesystem::path(file)});
  }
  check_names(images, place);
  return images;
}

AllSettings resolve_contender(const Contender& contender, const SettingSources& common) {
  SettingSources sources = common;
  sources.preset = contender.preset;
  sources.file = contender.file;
  AllSettings settings = resolve(sources);
  const SettingList list = describe(settings);
  AllSettings shared = resolve(common);
  for (const Setting& setting : describe(shared)) {
    if (is_shared(setting.name)) store(*find_setting(list, setting.name), load(setting));
  }
  assign_all(list, contender.settings, contender.name);
  return settings;
}

ReferenceSettings resolve_reference(const SettingSources& common, const std::vector<AllSettings>& contenders,
                                    const SettingTexts& own) {
  SettingSources sources = common;
  sources.preset = "reference";
  AllSettings asked = resolve(sources);
  AllSettings unbiased = resolve({.preset = sources.preset});
  ReferenceSettings result{.settings = asked};
  const SettingList list = describe(result.settings);
  for (const Setting& setting : describe(unbiased)) {
    if (belongs_to_reference(setting)) store(*find_setting(list, setting.name), load(setting));
  }
  if (!contenders.empty()) {
    int& bounces = result.settings.render.path.max_bounces;
    bounces = 0;
    for (const AllSettings& contender : contenders) bounces = std::max(bounces, contender.render.path.max_bounces);
  }
  assign_all(list, own, "--reference-settings");
  const SettingList with_flags = describe(asked);
  for (const Setting* setting : differing_settings(with_flags, list)) {
    const auto is_this = [&](const auto& flag) { return flag.first == setting->name; };
    if (belongs_to_reference(*setting) && std::any_of(common.flags.begin(), common.flags.end(), is_this))
      result.left_out.emplace_back(setting->name, to_string(*setting));
  }
  return result;
}

}  // namespace relume
