// What the interface knows and decides. Panels show it and change it; once a frame of the interface it becomes a
// request.
#pragma once

#include <array>
#include <deque>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "framebuffer/ocio_view.h"
#include "viewer/camera_path.h"
#include "viewer/document.h"
#include "viewer/file_watch.h"
#include "viewer/fly_camera.h"
#include "viewer/gl_image.h"
#include "viewer/navigation.h"
#include "viewer/render_thread.h"
#include "viewer/request.h"

namespace relume::viewer {

enum class Panel : int { settings, scene, camera, buffers };

/// How the inspected buffer is shown.
struct Inspector {
  bool automatic = true;  ///< range and mode follow the buffer
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

/// Passes of the latest frames of one side, for the graph.
struct FrameTimes {
  static constexpr size_t kMost = 240;
  struct Entry {
    double seconds = 0;
    std::vector<PassTime> passes;
  };
  std::deque<Entry> entries;
  std::vector<std::string> names;  ///< of passes, in the order in which they first appeared
  void add(const ViewerFrame& frame);
};

/// Recording and playing camera paths.
struct PathTools {
  CameraPath path;
  bool recording = false;
  bool playing = false;
  double since_s = 0;   ///< when recording or playing began
  float spacing_s = 2;  ///< between key frames that are added one by one
};

/// A scene with the state of its view.
struct SceneTab {
  Document document;
  std::array<AllSettings, kSides> settings;
  PathTools path;
  float speed = 1;
};

struct State {
  std::optional<Document> document;
  std::optional<SceneTab> previous;  ///< shown again if the new one cannot be compiled
  std::future<std::shared_ptr<const LoadedScene>> loading;
  std::string loading_name;
  /// Readings whose result is no longer wanted; std::async() waits for them where their futures are destroyed.
  std::vector<std::future<std::shared_ptr<const LoadedScene>>> superseded;
  bool reloads = false;         ///< `loading` reads the present scene again
  bool reload_dropped = false;  ///< for a scene that the user has opened; done later if that cannot be read
  bool watches = true;          ///< the scene is read again when its files change
  FileWatch watch;

  std::array<AllSettings, kSides> settings;
  AllSettings defaults;  ///< what "reset" goes back to
  int edited_side = 0;
  bool split = false;
  float split_at = 0.5f;
  bool follow_window = true;  ///< the image's size is that of its place in the window
  bool paused = false;
  ResolutionPolicy resolution_policy;
  std::shared_ptr<const OcioView> ocio;  ///< shows the image in place of the tone map; nullptr: the tone map

  std::string buffer;
  Inspector inspector;
  FlyCamera fly;
  Navigation navigation;
  bool flying = false;           ///< the user's camera, not the scene's
  bool camera_released = false;  ///< in favour of the scene's, since the last request
  bool awaits_camera = false;    ///< the scene's, which was requested but which no frame shows yet
  std::vector<Bookmark> bookmarks;
  std::filesystem::path bookmarks_file;  ///< empty: not kept
  PathTools path;
  Selection selection;
  std::future<PickResult> picked;  ///< under way
  bool pick_focuses = false;       ///< it is for the lens, not for selecting
  bool animating = false;
  float sun_hour = 12;
  int sun_day = 172;
  float latitude_deg = 48;

  Panel panel = Panel::settings;
  std::string setting_query;  ///< of the search field; empty: the essential settings
  bool panel_wanted = false;  ///< `panel` was chosen elsewhere than on its tab
  bool show_panels = true;
  bool show_help = false;
  bool sharp_pixels = false;
  std::deque<Toast> toasts;

  std::array<std::shared_ptr<const ViewerFrame>, kSides> frames;
  std::array<float, kSides> automatic_exposure{};  ///< stops; follows what frames meter
  std::array<FrameTimes, kSides> times;
  double frames_per_s = 0;  ///< rendered, both sides together counting as one
  double interface_hz = 0;

  RenderThread* renderer = nullptr;
  bool request_changed = true;
  bool image_changed = true;

  /// The image will differ.
  void touch() { request_changed = image_changed = true; }
  void notify(const std::string& text, bool problem = false);
  double now_s = 0;

  const ViewerFrame* frame() const { return frames[0].get(); }
  /// Whether the present camera is known: the user's, or that of a frame that shows the scene with its own.
  bool knows_camera() const;
  int sides() const { return split ? 2 : 1; }
  /// Whether what is shown follows that request, and no frame comes any more: every side has met --spp, --time or
  /// --error.
  bool reached_goals(uint64_t request_version) const;
};

/// Starts to load a scene; the one that is shown stays until it has been read. Replaces a reading of the present scene,
/// and is refused while another scene is being loaded.
void open_scene(State& state, const std::string& name);

/// Starts to read the scene again if its files have changed and are complete.
void follow_files(State& state);

/// Takes the loaded scene if it has arrived.
void finish_loading(State& state);

/// Shows a scene. The first comes with its settings resolved; later ones bring the settings that their file asks for.
void show_document(State& state, std::shared_ptr<const LoadedScene> loaded, bool first);

/// Shows the same scene as it was read again. Camera, settings, time and selection stay, and edits as far as
/// Document::repeat_edits() can repeat them. Returns what it cannot repeat.
std::vector<std::string> replace_scene(State& state, std::shared_ptr<const LoadedScene> loaded);

/// Goes back to the scene before, if there is one: the present one cannot be shown.
void revert_document(State& state);

/// Sets a setting of a side as its flag would. Throws Error; nothing is changed then.
void change_setting(State& state, int side, const std::string& name, const std::string& text);

/// Replaces settings of a side: checks that they combine, and takes an environment on that they name. Throws Error.
void take_settings(State& state, int side, const AllSettings& settings);

/// Applies a preset to a side. Throws Error.
void apply_preset(State& state, int side, const std::string& name);

/// Renders both sides, or A alone.
void set_split(State& state, bool split);

/// Goes to a moment of the animation.
void set_scene_time(State& state, float time_s);

/// The camera that is shown: the user's, or the scene's. Means nothing unless State::knows_camera().
CameraPose current_camera(const State& state);

/// Puts the camera somewhere; it is the user's from now on.
void set_view(State& state, const Viewpoint& view);
Viewpoint current_view(const State& state);

/// Goes back to the scene's camera.
void release_camera(State& state);

void save_bookmarks(State& state);

RenderRequest make_request(const State& state, uint64_t version, uint64_t image_version);

}  // namespace relume::viewer
