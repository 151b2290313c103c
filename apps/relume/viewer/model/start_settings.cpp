#include "viewer/model/start_settings.h"

#include <algorithm>

#include "relume/error.h"
#include "render/build_pipeline.h"
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

/// Copies the image's settings, environment, display and stop criteria from `current` to `wanted`.
void keep_image(AllSettings current, AllSettings& wanted) {
  const SettingList from = describe_image(current.render);
  const SettingList to = describe_image(wanted.render);
  for (size_t i = 0; i < from.size(); ++i) assign(to[i], to_string(from[i]), "");
  wanted.scene = current.scene;
  wanted.output = current.output;
  wanted.stop = current.stop;
}

}  // namespace

AllSettings resolve_start(SettingSources sources) {
  if (!chooses_technique(sources)) sources.preset = "interactive";
  return resolve(sources);
}

bool chooses_size(const SettingSources& sources) {
  const RenderSettings plain;
  const RenderSettings chosen = resolve({.file = sources.file}).render;
  return chosen.width != plain.width || chosen.height != plain.height ||
         std::any_of(sources.flags.begin(), sources.flags.end(),
                     [](const auto& flag) { return flag.first == "width" || flag.first == "height"; });
}

AllSettings apply_preset(const AllSettings& current, const std::string& scene_json, const std::string& scene_place,
                         const std::string& preset) {
  AllSettings wanted = resolve({.scene_json = scene_json, .scene_place = scene_place});
  keep_image(current, wanted);
  wanted.render.path.max_bounces = current.render.path.max_bounces;
  settings_from_json(describe(wanted), require_preset(preset).json, "preset " + preset);
  wanted.stop = current.stop;  // the number of samples in a preset is for finite renders
  return wanted;
}

AllSettings settings_in_scene(const AllSettings& current, const std::string& scene_json,
                              const std::string& scene_place) {
  AllSettings kept = current;
  kept.render.camera.clear();
  kept.render.time_s = 0;
  kept.render.shutter_s = 0;
  kept.scene.env.clear();
  if (scene_json.empty()) return kept;
  AllSettings over = kept;
  settings_from_json(describe(over), scene_json, scene_place);
  if (refusal(over.render).empty()) return over;
  AllSettings own = resolve_start({.scene_json = scene_json, .scene_place = scene_place});
  if (const std::string why = refusal(own.render); !why.empty()) throw Error(scene_place + ": " + why);
  keep_image(over, own);
  return own;
}

}  // namespace relume::viewer
