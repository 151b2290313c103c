// All settings of a render: what the session computes, what the scene is overridden with, when to stop, and what is
// done with the image. Flags, JSON files, presets, image metadata and docs/settings.md cover exactly these.
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

/// What replaces parts of the scene.
struct SceneOverrides {
  /// Environment: "studio", "sky", "sun_sky", "none", "R,G,B", or an EXR or HDR file; empty: the scene's own.
  std::string env;
  float env_rotation_deg = 0;  ///< about +Y, added
  float env_exposure = 0;      ///< stops
  std::string variant;         ///< one of Scene::variants; empty: the materials that the file gives its meshes

  friend bool operator==(const SceneOverrides&, const SceneOverrides&) = default;
};

/// When an image is done: whichever comes first.
struct StopSettings {
  int spp = 0;       ///< samples a pixel; 0: no limit if another criterion is set, or else kDefaultSpp
  float time_s = 0;  ///< render time; 0: no limit
  float error = 0;   ///< Session::estimated_error(); 0: no limit
};
inline constexpr int kDefaultSpp = 64;

/// A tone map, with its own number, or one that depends on the light.
enum class ToneMapChoice : int { none = 0, automatic = static_cast<int>(kToneMapNames.size()) };

/// How linear radiance becomes a display-ready image. EXR and HDR files hold radiance and ignore it.
struct OutputSettings {
  std::optional<float> exposure = std::nullopt;  ///< stops; std::nullopt: metered (display_for())
  ToneMapChoice tone_map = ToneMapChoice::automatic;

  /// std::nullopt if it is automatic.
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

/// Throws Error for whatever does not fit. `settings` hold the defaults.
AllSettings resolve(const SettingSources& sources, AllSettings settings = {});

/// Gives the image the aspect ratio of the camera, if that has one. Keeps the dimension that a source gives; if none
/// gives one, keeps the larger.
void fit_to_camera(AllSettings& settings, const SettingSources& sources, const Scene& scene);

/// Applies `overrides` to the scene. Throws Error (unreadable file, numbers that are not a radiance).
void apply(const SceneOverrides& overrides, Scene& scene);

}  // namespace relume
