// Settings at start, and those of a preset applied later.
#pragma once

#include <string>

#include "render/settings.h"

namespace relume::viewer {

/// Like resolve(), but with the techniques of the preset "interactive" if neither flags, preset, file nor scene choose
/// techniques. Throws Error.
AllSettings resolve_start(SettingSources sources);

/// Whether flags or a settings file choose a size of image other than the default; the window then does not. Throws
/// Error.
bool chooses_size(const SettingSources& sources);

/// Applies `preset` to a scene. Kept from `current`: the group "Image", the environment, stop criteria and display
/// settings, and the number of bounces unless the preset sets it. `scene_json` and `scene_place` are those of
/// SettingSources. Throws Error.
AllSettings apply_preset(const AllSettings& current, const std::string& scene_json, const std::string& scene_place,
                         const std::string& preset);

/// Settings of a side in another scene: `current` without the settings that belong to the previous scene, overridden by
/// those of the new scene. If the two do not combine, uses the techniques with which the viewer starts in that scene.
/// Throws Error.
AllSettings settings_in_scene(const AllSettings& current, const std::string& scene_json,
                              const std::string& scene_place);

}  // namespace relume::viewer
