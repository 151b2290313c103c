#include "viewer/start_settings.h"

#include <algorithm>

#include "render/presets.h"
#include "settings/settings_json.h"

namespace relume::viewer {
namespace {

bool chooses_technique(const SettingSources& sources) {
  if (!sources.preset.empty() || !sources.file.empty()) return true;
  RenderSettings defaults;
  RenderSettings chosen = resolve(sources).render;
  const SettingList default_slots = describe_slots(defaults);
  const SettingList slots = describe_slots(chosen);
  for (size_t i = 0; i < slots.size(); ++i) {
    const auto is_slot = [&](const auto& flag) { return flag.first == slots[i].name; };
    if (std::any_of(sources.flags.begin(), sources.flags.end(), is_slot)) return true;
    if (to_string(slots[i]) != to_string(default_slots[i])) return true;
  }
  return false;
}

}  // namespace

Settings resolve_start(SettingSources sources) {
  if (!chooses_technique(sources)) sources.preset = "interactive";
  return resolve(sources);
}

Settings apply_preset(const Settings& current, const std::string& scene_json, const std::string& scene_place,
                      const std::string& preset) {
  Settings kept = current;
  Settings wanted = resolve({.scene_json = scene_json, .scene_place = scene_place});
  const SettingList from = describe_picture(kept.render);
  const SettingList to = describe_picture(wanted.render);
  for (size_t i = 0; i < from.size(); ++i) assign(to[i], to_string(from[i]), "");
  wanted.scene = kept.scene;
  wanted.output = kept.output;
  wanted.render.path.max_bounces = kept.render.path.max_bounces;
  settings_from_json(describe(wanted), require_preset(preset).json, "preset " + preset);
  wanted.stop = kept.stop;  // a preset's number of samples is for pictures that end
  return wanted;
}

}  // namespace relume::viewer
