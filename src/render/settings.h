// All settings of a render: session, scene overrides, stopping and output. Flags, JSON files, presets, image metadata
// and docs/settings.md cover exactly these.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "framebuffer/tone_map.h"
#include "render/render_settings.h"
#include "settings/settings_docs.h"

namespace relume {

struct Scene;

/// Replacements of parts of the scene.
struct SceneOverrides {
  /// Environment: "studio", "sky", "sun_sky", "none", "R,G,B", or an EXR or HDR file; empty: the scene's own.
  std::string env;
  float env_rotation_deg = 0;  ///< added rotation about +Y
  float env_exposure = 0;      ///< stops
  std::string variant;         ///< one of Scene::variants; empty: the file's default materials

  friend bool operator==(const SceneOverrides&, const SceneOverrides&) = default;
};

/// Stopping criteria; the first one met ends the image.
struct StopSettings {
  int spp = 0;       ///< samples per pixel; 0: no limit if another criterion is set, otherwise kDefaultSpp
  float time_s = 0;  ///< render time; 0: no limit
  float error = 0;   ///< Session::estimated_error(); 0: no limit
};
inline constexpr int kDefaultSpp = 64;

/// A tone map by its number, or the automatic one, which depends on the light.
enum class ToneMapChoice : int { none = 0, automatic = static_cast<int>(kToneMapNames.size()) };

/// Conversion of linear radiance to a display image. EXR and HDR files store radiance and ignore it.
struct OutputSettings {
  std::optional<float> exposure = std::nullopt;  ///< stops; std::nullopt: metered (display_for())
  ToneMapChoice tone_map = ToneMapChoice::automatic;

  /// Returns std::nullopt if the tone map is automatic.
  std::optional<ToneMap> fixed_tone_map() const {
    if (tone_map == ToneMapChoice::automatic) return std::nullopt;
    return static_cast<ToneMap>(tone_map);
  }
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

/// Groups in the order of help and docs/settings.md.
std::vector<SettingGroup> setting_groups(AllSettings& settings);
SettingList describe(AllSettings& settings);

/// Values of the public interface's settings.
const AllSettings& all_settings(const Settings& settings);

/// Text of docs/settings.md.
std::string settings_reference();

/// Sources of settings. Later ones override earlier ones: defaults, scene, preset, file, flags.
struct SettingSources {
  std::string scene_json = {};                                  ///< Scene::settings_json; empty: none
  std::string scene_place = {};                                 ///< the scene's name in messages
  std::string preset = {};                                      ///< empty: none
  std::string file = {};                                        ///< JSON, or an EXR that relume wrote; empty: none
  std::vector<std::pair<std::string, std::string>> flags = {};  ///< name (without dashes) and text
};

/// Combines the sources; `settings` hold the defaults. Throws Error for invalid settings.
AllSettings resolve(const SettingSources& sources, AllSettings settings = {});

/// Gives the image the camera's aspect ratio, if it has one. Keeps the dimension that a source sets; if none does,
/// keeps the larger one.
void fit_to_camera(AllSettings& settings, const SettingSources& sources, const Scene& scene);

/// Applies `overrides` to the scene. Throws Error (unreadable file, invalid radiance).
void apply(const SceneOverrides& overrides, Scene& scene);

}  // namespace relume
