// State of the interface. Panels show and change it; once per frame of the interface, it becomes a request.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/model/camera_path.h"
#include "viewer/model/document.h"
#include "viewer/model/file_watch.h"
#include "viewer/model/fly_camera.h"
#include "viewer/model/navigation.h"
#include "viewer/render/display_table.h"
#include "viewer/render/display_transform.h"
#include "viewer/render/render_thread.h"
#include "viewer/render/request.h"

namespace relume::viewer {

enum class Panel : int { settings, scene, camera, buffers };

/// Display of the inspected buffer.
struct Inspector {
  bool automatic = true;  ///< whether range and mode follow the buffer
  DisplayTransform display_transform;
  bool loupe = false;
  int loupe_zoom = 8;
};

enum class Selected : int { nothing, node, light, material };

struct Selection {
  Selected kind = Selected::nothing;
  Index index = kNone;
};

struct Toast {
  std::string text;
  bool problem = false;
  double until_s = 0;
};

/// Passes of the latest frames of a side, for the graph.
struct FrameTimes {
  static constexpr size_t kMost = 240;
  struct Entry {
    double seconds = 0;
    std::vector<PassTime> passes;
  };
  std::deque<Entry> entries;
  std::vector<std::string> names;  ///< names of passes, in order of first appearance
  void add(const ViewerFrame& frame);
  /// Mean time of a pass over the last 20 frames, seconds; of all passes for an empty name.
  double mean_s(const std::string& name) const;
};

/// Recording and playback of camera paths.
struct PathTools {
  CameraPath path;
  bool recording = false;
  bool playing = false;
  double since_s = 0;   ///< start of recording or playback
  float spacing_s = 2;  ///< between key frames added one at a time
};

/// A scene and the state of its view.
struct SceneTab {
  Document document;
  std::array<AllSettings, kSides> settings;
  PathTools path;
  float speed = 1;
};

struct State {
  std::optional<Document> document;
  std::optional<SceneTab> previous;  ///< restored if the new one cannot be compiled
  std::future<std::shared_ptr<const LoadedScene>> loading;
  std::string loading_name;
  /// Unwanted loads in progress; kept because the destructor of a future of std::async() blocks.
  std::vector<std::future<std::shared_ptr<const LoadedScene>>> superseded;
  bool reloads = false;  ///< whether `loading` reloads the present scene
  bool reload_dropped =
      false;  ///< whether a reload yielded to a scene opened by the user; repeated if that scene fails to load
  bool watches = true;  ///< whether changed files reload the scene
  FileWatch watch;

  std::array<AllSettings, kSides> settings;
  AllSettings defaults;  ///< targets of "Reset"
  int edited_side = 0;
  bool split = false;
  float split_at = 0.5f;
  bool follow_window = true;  ///< whether the image's size follows its area in the window
  bool paused = false;
  bool unwatched = false;  ///< whether a server has no viewer, and pauses until one connects
  ResolutionPolicy resolution_policy;
  OcioDisplay ocio;  ///< may replace the tone map

  std::string buffer;
  Inspector inspector;
  FlyCamera fly;
  Navigation navigation;
  bool flying = false;           ///< whether the camera is the user's, not the scene's
  bool camera_released = false;  ///< whether the camera returned to the scene's since the last request
  bool awaits_camera = false;    ///< whether no frame shows the requested scene camera yet
  std::vector<Bookmark> bookmarks;
  std::filesystem::path bookmarks_file;  ///< empty: bookmarks are not stored
  PathTools path;
  Selection selection;
  std::future<PickResult> picked;  ///< pending result
  bool pick_focuses = false;       ///< whether it sets the focus instead of the selection
  bool animating = false;
  float sun_hour = 12;
  int sun_day = 172;
  float latitude_deg = 48;

  Panel panel = Panel::settings;
  std::string setting_query;  ///< text of the search field; empty: the essential settings
  bool panel_wanted = false;  ///< whether `panel` was chosen by other means than its tab
  bool show_panels = true;
  bool show_help = false;
  bool sharp_pixels = false;
  std::deque<Toast> toasts;

  std::array<std::shared_ptr<const ViewerFrame>, kSides> frames;
  std::array<float, kSides> automatic_exposure{};  ///< stops, adapted to metered frames
  std::array<FrameTimes, kSides> times;
  double frames_per_s = 0;  ///< rendered; a pair of both sides counts as one
  double interface_hz = 0;

  RenderThread* renderer = nullptr;
  bool request_changed = true;
  bool image_changed = true;

  /// Marks the image as changed.
  void touch() { request_changed = image_changed = true; }
  void notify(const std::string& text, bool problem = false);
  double now_s = 0;

  const ViewerFrame* frame() const { return frames[0].get(); }
  /// Whether the present camera is known: the user's, or that of a frame with the scene's camera.
  bool has_camera() const;
  int sides() const { return split ? 2 : 1; }
  /// Whether the display follows that request and is final: every side has met --spp, --time or --error.
  bool reached_goals(uint64_t request_version) const;
};

/// Starts to load a scene; the present one stays until loading is complete. Replaces a reload of the present scene, but
/// is rejected while another scene is loading.
void open_scene(State& state, const std::string& name);

/// Starts to reload the scene if its files have changed and are complete.
void follow_files(State& state);

/// Shows the loaded scene once it is complete.
void finish_loading(State& state);

/// Shows a scene. The first has resolved settings; later ones apply the settings in their file.
void show_document(State& state, std::shared_ptr<const LoadedScene> loaded, bool first);

/// Shows the reloaded scene. Keeps camera, settings, time, selection, and the edits that Document::repeat_edits() can
/// repeat. Returns those that it cannot.
std::vector<std::string> replace_scene(State& state, std::shared_ptr<const LoadedScene> loaded);

/// Returns to the previous scene, if any, because the present one cannot be shown.
void revert_document(State& state);

/// Sets a setting of a side like its flag. Throws Error, leaving the state unchanged.
void change_setting(State& state, int side, const std::string& name, const std::string& text);

/// Replaces settings of a side: checks that they combine, and applies their environment. Throws Error.
void take_settings(State& state, int side, const AllSettings& settings);

/// Applies a preset to a side. Throws Error.
void apply_preset(State& state, int side, const std::string& name);

/// Renders both sides, or A alone.
void set_split(State& state, bool split);

/// Sets the time of the animation.
void set_scene_time(State& state, float time_s);

/// The displayed camera: the user's, or the scene's. Valid only if State::has_camera().
CameraPose current_camera(const State& state);

/// Sets the user's camera.
void set_view(State& state, const Viewpoint& view);
Viewpoint current_view(const State& state);

/// Returns to the scene's camera.
void release_camera(State& state);

void save_bookmarks(State& state);

RenderRequest make_request(const State& state, uint64_t version, uint64_t image_version);

}  // namespace relume::viewer
