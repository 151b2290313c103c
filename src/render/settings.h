// All settings of a render: what the session computes, what the scene is overridden with, when to stop, and what is
// done with the image. Flags, JSON files, presets, image metadata and docs/settings.md cover exactly these.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framebuffer/tone_map.h"
#include "render/render_settings.h"
#include "settings/settings_docs.h"

namespace relume {

struct Scene;

/// What replaces parts of the scene.
struct SceneOverrides {
  std::string env;  ///< environment: "R,G,B", "none", or an EXR or HDR file; empty: the scene's own
};

/// When an image is done: whichever comes first.
struct StopSettings {
  int spp = 0;       ///< samples a pixel; 0: no limit if another criterion is set, or else kDefaultSpp
  float time_s = 0;  ///< render time; 0: no limit
  float error = 0;   ///< Session::estimated_error(); 0: no limit
};
inline constexpr int kDefaultSpp = 64;

/// How linear radiance becomes a display-ready image. EXR and HDR files hold radiance and ignore it.
struct OutputSettings {
  float exposure = 0;  ///< stops
  ToneMap tone_map = ToneMap::agx;
};

struct AllSettings {
  RenderSettings render;
  SceneOverrides scene;
  StopSettings stop;
  OutputSettings output;
};

SettingList describe(SceneOverrides& settings);
SettingList describe(StopSettings& settings);
SettingList describe(OutputSettings& settings);

/// In the order in which help and docs/settings.md show them.
std::vector<SettingGroup> setting_groups(AllSettings& settings);
SettingList describe(AllSettings& settings);

/// The values of the public interface's settings.
const AllSettings& all_settings(const Settings& settings);

/// Text of docs/settings.md.
std::string settings_reference();

/// Where settings come from; later ones win: defaults, the scene, the preset, the file, the flags.
struct SettingSources {
  std::string scene_json = {};                                  ///< Scene::settings_json; empty: none
  std::string scene_place = {};                                 ///< the scene's name in messages
  std::string preset = {};                                      ///< empty: none
  std::string file = {};                                        ///< JSON, or an EXR that relume wrote; empty: none
  std::vector<std::pair<std::string, std::string>> flags = {};  ///< name (without dashes) and text
};

/// Throws Error for whatever does not fit.
AllSettings resolve(const SettingSources& sources);

/// Applies `overrides` to the scene. Throws Error (unreadable file, numbers that are not a radiance).
void apply(const SceneOverrides& overrides, Scene& scene);

}  // namespace relume
