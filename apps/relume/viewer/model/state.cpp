#include "viewer/model/state.h"

#include <algorithm>
#include <chrono>
#include <new>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "builtin_scenes/builtin.h"
#include "cli/platform.h"
#include "cli/scene_source.h"
#include "core/clock.h"
#include "core/fnv1a.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/presets.h"
#include "viewer/model/start_settings.h"

namespace relume::viewer {
namespace {

constexpr double kToast_s = 5;
constexpr double kProblemToast_s = 12;
constexpr size_t kMostToasts = 5;

std::filesystem::path bookmarks_file_of(const std::string& scene) {
  const std::string folder = cli::state_folder();
  if (folder.empty()) return {};
  std::error_code failure;
  // Distinguishes scenes of the same name in different folders.
  const bool is_file = !find_builtin_scene(scene) && std::filesystem::exists(scene, failure);
  const std::string name = is_file ? std::filesystem::weakly_canonical(scene, failure).string() : scene;
  Fnv1a key;
  key.add(name.data(), name.size());
  return std::filesystem::path(folder) / "bookmarks" / fmt::format("{:016x}.json", key.value());
}

/// Loads the bookmarks of the displayed scene.
void load_bookmarks(State& state) {
  state.bookmarks_file = bookmarks_file_of(state.document->name());
  state.bookmarks.clear();
  try {
    if (!state.bookmarks_file.empty()) state.bookmarks = read_bookmarks(state.bookmarks_file);
  } catch (const Error& error) {
    state.notify(error.what(), true);
    state.bookmarks_file.clear();  // prevents overwriting it
  }
}

SceneOverrides of_environment(SceneOverrides overrides) {
  overrides.variant.clear();  // of materials
  return overrides;
}

/// Throws Error if the map cannot be read.
Environment environment_in(const LoadedScene& loaded, const SceneOverrides& overrides) {
  Scene scene;
  scene.environment = loaded.scene.environment;
  apply(of_environment(overrides), scene);
  return std::move(scene.environment);
}

void start_loading(State& state, const std::string& name) {
  state.loading_name = name;
  state.loading = std::async(std::launch::async, [name] {
    cli::lower_thread_priority();
    const double start_s = now_s();
    const auto read_from = std::filesystem::file_time_type::clock::now();
    Scene scene = cli::open_scene(name);
    return std::make_shared<const LoadedScene>(LoadedScene{name, std::move(scene), now_s() - start_s, read_from});
  });
}

bool is_done(const std::future<std::shared_ptr<const LoadedScene>>& loading) {
  return loading.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

/// Watches the files of the scene, and of the environment that overrides its own.
void watch_files(State& state) {
  const LoadedScene& loaded = *state.document->loaded();
  std::vector<std::filesystem::path> files = loaded.scene.source_files;
  std::error_code failure;
  const std::string& env = state.settings[0].scene.env;
  if (std::filesystem::is_regular_file(env, failure)) files.emplace_back(env);
  state.watch.watch(files, loaded.read_from);
}

/// Shows the loaded scene, and notifies the user.
void take_loaded(State& state, std::shared_ptr<const LoadedScene> loaded) {
  if (state.reloads) {
    const std::vector<std::string> lost = replace_scene(state, std::move(loaded));
    state.notify("reloaded " + state.document->name() + ", which changed on disk");
    if (!lost.empty())
      state.notify(fmt::format("edits of {} are lost; only items with a unique name in the file keep theirs",
                               fmt::join(lost, ", ")),
                   true);
  } else {
    show_document(state, std::move(loaded), false);
    state.notify("opened " + state.document->name());
  }
  const size_t warnings = state.document->loaded()->scene.warnings.size();
  if (warnings > 0) state.notify(fmt::format("the loader gave {} warnings; `relume info` lists them", warnings));
}

/// Keeps the present scene for revert_document(), unless it was never displayed.
void remember_document(State& state) {
  if (!state.previous) state.previous = {std::move(*state.document), state.settings, state.path, state.fly.speed};
}

/// Applies the playing clips and the variant to `document`; unknown names fall back to the first clip and the default
/// materials.
void play_again(State& state, Document& document) {
  try {
    document.play(state.settings[0].render.animation);
  } catch (const Error&) {
    for (AllSettings& side : state.settings) side.render.animation.clear();
  }
  try {
    document.choose_variant(state.settings[0].scene.variant);
  } catch (const Error&) {
    for (AllSettings& side : state.settings) side.scene.variant.clear();
  }
}

/// Whether the selected item has the same index and name in the other document.
bool has_selection(const State& state, const Document& other) {
  const auto same = [&](const auto& now, const auto& then) {
    const auto i = static_cast<size_t>(state.selection.index);
    return i < now.size() && i < then.size() && now[i].name == then[i].name;
  };
  const Scene& now = other.outline();
  const Scene& then = state.document->outline();
  switch (state.selection.kind) {
    case Selected::node: return same(now.nodes, then.nodes);
    case Selected::light: return same(now.lights, then.lights);
    case Selected::material: return same(now.materials, then.materials);
    default: return false;
  }
}

}  // namespace

void FrameTimes::add(const ViewerFrame& frame) {
  entries.push_back({frame.seconds, frame.passes});
  if (entries.size() > kMost) entries.pop_front();
  for (const PassTime& pass : frame.passes) {
    if (std::find(names.begin(), names.end(), pass.name) == names.end()) names.push_back(pass.name);
  }
}

double FrameTimes::mean_s(const std::string& name) const {
  constexpr size_t kFrames = 20;
  double sum = 0;
  const size_t count = std::min(kFrames, entries.size());
  for (size_t i = entries.size() - count; i < entries.size(); ++i) {
    for (const PassTime& pass : entries[i].passes) {
      if (name.empty() || pass.name == name) sum += pass.seconds;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

bool State::has_camera() const {
  if (!document) return false;
  if (document->edits().camera.value) return true;
  return frame() && frame()->scene == document->loaded() && !camera_released && !awaits_camera;
}

bool State::reached_goals(uint64_t request_version) const {
  return std::all_of(frames.begin(), frames.begin() + sides(), [&](const auto& side) {
    return side && side->request_version >= request_version && side->reached_goal;
  });
}

void State::notify(const std::string& text, bool problem) {
  std::erase_if(toasts, [&](const Toast& toast) { return toast.text == text; });
  toasts.push_back({text, problem, now_s + (problem ? kProblemToast_s : kToast_s)});
  if (toasts.size() > kMostToasts) toasts.pop_front();
}

void open_scene(State& state, const std::string& name) {
  if (state.loading.valid() && !state.reloads) return state.notify("another scene is still loading; wait for it");
  if (state.loading.valid()) {
    state.superseded.push_back(std::move(state.loading));
    state.reload_dropped = true;
  }
  state.reloads = false;
  start_loading(state, name);
}

void follow_files(State& state) {
  if (!state.watches || !state.document || state.loading.valid()) return;
  const bool dropped = std::exchange(state.reload_dropped, false);
  if (!state.watch.changed(state.now_s) && !dropped) return;
  state.reloads = true;
  start_loading(state, state.document->name());
}

void finish_loading(State& state) {
  std::erase_if(state.superseded, is_done);
  if (!state.loading.valid() || !is_done(state.loading)) return;
  const char* consequence = state.reloads ? "; the scene stays as it was" : "";
  try {
    take_loaded(state, state.loading.get());
  } catch (const std::bad_alloc&) {
    state.notify(state.loading_name + ": not enough memory for this scene" + consequence, true);
  } catch (const std::exception& error) {
    state.notify(error.what() + std::string(consequence), true);
  }
}

void show_document(State& state, std::shared_ptr<const LoadedScene> loaded, bool first) {
  // Does everything that can fail before the state changes.
  std::array<AllSettings, kSides> settings = state.settings;
  if (!first) {
    for (AllSettings& side : settings) {
      side = settings_in_scene(side, loaded->scene.settings_json, loaded->name);
      side.render.animation.clear();
      side.scene.variant.clear();
    }
  }
  Document document(loaded);
  if (of_environment(settings[0].scene) != SceneOverrides{})
    document.replace_environment(environment_in(*loaded, settings[0].scene));
  document.set_time(settings[0].render.time_s);
  document.play(settings[0].render.animation);
  document.choose_variant(settings[0].scene.variant);

  state.reload_dropped = false;
  if (!first) remember_document(state);
  state.document.emplace(std::move(document));
  state.settings = settings;
  state.selection = {};
  state.flying = state.camera_released = state.awaits_camera = false;
  // Animated models play at once; built-in scenes have no clips and stay still.
  state.animating = !state.document->outline().clips.empty() && state.document->time_s() == 0;
  state.path = {};
  state.picked = {};
  const float size = state.document->bounds().diagonal();
  state.fly.speed = clamp(0.15f * size, 0.01f, 100.0f);
  state.navigation = {};
  choose_mode(state);
  watch_files(state);
  load_bookmarks(state);
  state.touch();
}

std::vector<std::string> replace_scene(State& state, std::shared_ptr<const LoadedScene> loaded) {
  Document document(loaded);
  if (of_environment(state.settings[0].scene) != SceneOverrides{})
    document.replace_environment(environment_in(*loaded, state.settings[0].scene));
  document.set_time(state.document->time_s());
  play_again(state, document);
  if (const auto& camera = state.document->edits().camera.value) document.set_camera(camera);
  std::vector<std::string> lost = document.repeat_edits(*state.document);
  if (!has_selection(state, document)) state.selection = {};
  remember_document(state);
  state.document.emplace(std::move(document));
  state.picked = {};
  state.navigation.pace = {};
  watch_files(state);
  state.touch();
  return lost;
}

void revert_document(State& state) {
  if (!state.previous) return;
  state.document.emplace(std::move(state.previous->document));
  state.settings = state.previous->settings;
  state.path = state.previous->path;
  state.fly.speed = state.previous->speed;
  state.previous.reset();
  state.picked = {};
  load_bookmarks(state);
  state.selection = {};
  state.flying = state.document->edits().camera.value.has_value();
  state.navigation.pace = {};
  watch_files(state);
  state.touch();
}

void take_settings(State& state, int side, const AllSettings& wanted) {
  AllSettings& current = state.settings[static_cast<size_t>(side)];
  check_combination(wanted.render);
  if (state.document) find_camera(state.document->outline(), wanted.render.camera);
  if (state.document && wanted.render.animation != current.render.animation)
    state.document->play(wanted.render.animation);
  if (state.document && wanted.scene.variant != current.scene.variant)
    state.document->choose_variant(wanted.scene.variant);
  if (of_environment(wanted.scene) != of_environment(current.scene) && state.document) {
    if (of_environment(wanted.scene) == SceneOverrides{}) {
      state.document->restore_environment();
    } else {
      state.document->replace_environment(environment_in(*state.document->loaded(), wanted.scene));
    }
  }
  if (state.document && wanted.render.time_s != state.document->time_s())
    state.document->set_time(wanted.render.time_s);
  if (wanted.render.camera != current.render.camera) release_camera(state);
  current = wanted;
  // Both sides share one scene and image: their settings are copied.
  AllSettings& other = state.settings[static_cast<size_t>(1 - side)];
  other.scene = current.scene;
  other.render.camera = current.render.camera;
  other.render.animation = current.render.animation;
  other.render.time_s = current.render.time_s;
  other.render.width = current.render.width;
  other.render.height = current.render.height;
  if (state.document) watch_files(state);
  state.touch();
}

void change_setting(State& state, int side, const std::string& name, const std::string& text) {
  AllSettings wanted = state.settings[static_cast<size_t>(side)];
  const SettingList list = describe(wanted);
  assign(require_setting(list, name, "set"), text, "");
  if (name == "width" || name == "height") state.follow_window = false;
  take_settings(state, side, wanted);
}

void apply_preset(State& state, int side, const std::string& name) {
  const AllSettings& current = state.settings[static_cast<size_t>(side)];
  const LoadedScene& loaded = *state.document->loaded();
  take_settings(state, side, apply_preset(current, loaded.scene.settings_json, loaded.name, name));
}

void set_split(State& state, bool split) {
  state.split = split;
  if (!split) state.edited_side = 0;
  state.touch();
}

void set_scene_time(State& state, float time_s) {
  state.document->set_time(time_s);
  for (AllSettings& settings : state.settings) settings.render.time_s = time_s;
  state.touch();
}

CameraPose current_camera(const State& state) {
  if (state.document && state.document->edits().camera.value) return *state.document->edits().camera.value;
  return state.frame() ? state.frame()->camera : CameraPose{};
}

Viewpoint current_view(const State& state) {
  const CameraPose placed = current_camera(state);
  FlyCamera fly;
  fly.place(placed.to_world);
  return {fly.eye(), fly.rotation(), placed.camera.fov_y_rad};
}

void set_view(State& state, const Viewpoint& view) {
  CameraPose placed = current_camera(state);
  state.fly.place(view.eye, view.rotation);
  state.flying = true;
  placed.to_world = state.fly.to_world();
  placed.camera.fov_y_rad = view.fov_y_rad;
  state.document->set_camera(placed);
  state.touch();
}

void release_camera(State& state) {
  state.flying = false;
  state.camera_released = true;
  if (state.document && state.document->edits().camera.value) state.document->set_camera(std::nullopt);
  state.touch();
}

void save_bookmarks(State& state) {
  if (state.bookmarks_file.empty()) return;
  try {
    write_bookmarks(state.bookmarks_file, state.bookmarks);
  } catch (const Error& error) {
    state.notify(error.what(), true);
  }
}

RenderRequest make_request(const State& state, uint64_t version, uint64_t image_version) {
  RenderRequest request;
  request.version = version;
  request.image_version = image_version;
  request.settings = state.settings;
  request.split = state.split;
  request.paused = state.paused || state.unwatched;
  request.resolution_policy = state.resolution_policy;
  request.buffer = state.buffer;
  if (!state.document) return request;
  request.scene = state.document->loaded();
  request.edits = state.document->edits();
  return request;
}

}  // namespace relume::viewer
