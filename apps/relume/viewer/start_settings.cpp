#include "viewer/start_settings.h"

#include <algorithm>

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

}  // namespace relume::viewer
