// The settings that the viewer opens with, and those that a preset gives it later.
#pragma once

#include <string>

#include "render/settings.h"

namespace relume::viewer {

/// As resolve(); where neither flags, preset, file nor scene say anything of techniques, with those of the preset
/// "interactive". Throws Error.
Settings resolve_start(SettingSources sources);

/// What `preset` means for a scene: `current` decides only what is rendered (the group "Picture" and the environment),
/// how many bounces unless the preset does, when to stop and how it is displayed. `scene_json` and `scene_place` are
/// those of SettingSources. Throws Error.
Settings apply_preset(const Settings& current, const std::string& scene_json, const std::string& scene_place,
                      const std::string& preset);

}  // namespace relume::viewer
