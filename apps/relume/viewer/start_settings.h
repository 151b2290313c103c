// The settings that the viewer opens with, and those that a preset gives it later.
#pragma once

#include <string>

#include "render/settings.h"

namespace relume::viewer {

/// As resolve(); where neither flags, preset, file nor scene say anything of techniques, with those of the preset
/// "interactive". Throws Error.
AllSettings resolve_start(SettingSources sources);

/// Whether the user asks for a size of image, by flags or by a file of settings that has another than the default:
/// the window does not decide it then. Throws Error.
bool chooses_size(const SettingSources& sources);

/// What `preset` means for a scene: `current` decides only what is rendered (the group "Image" and the environment),
/// how many bounces unless the preset does, when to stop and how it is displayed. `scene_json` and `scene_place` are
/// those of SettingSources. Throws Error.
AllSettings apply_preset(const AllSettings& current, const std::string& scene_json, const std::string& scene_place,
                         const std::string& preset);

/// What a side goes on with in another scene: `current` without what speaks of the scene before. Where the scene brings
/// settings of its own, those are laid over it; if the two do not combine, the techniques are those with which the
/// viewer starts with that scene. Throws Error.
AllSettings settings_in_scene(const AllSettings& current, const std::string& scene_json,
                              const std::string& scene_place);

}  // namespace relume::viewer
