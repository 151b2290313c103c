#include "viewer/model/actions.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include <fmt/format.h>
#include <glm/trigonometric.hpp>

#include "cli/image.h"
#include "cli/platform.h"
#include "cli/reports.h"
#include "files/extension.h"
#include "relume/error.h"
#include "render/display.h"
#include "viewer/model/save_view.h"
#include "viewer/model/sun_path.h"

namespace relume::viewer {
namespace {

constexpr double kRecordInterval_s = 0.1;
constexpr const char* kNoCamera = "the camera is unknown until the first image; wait for it";

/// Depth of the selection along the viewing direction; 0 if the selection has no position.
float selection_depth(const State& state, const CameraPose& camera) {
  // Of a figure itself: the node that moves it may also carry other objects.
  const Index node = state.selection.kind == Selected::node ? state.selection.index : selected_node(state);
  if (node == kNone) return 0;
  const Document& document = *state.document;
  const Box box = document.bounds(node);
  const Vec3 point = box.empty() ? Vec3(document.world()[static_cast<size_t>(node)][3]) : box.center();
  return depth_of(camera, point);
}

/// Focuses on a point: at its depth, or at its distance for a panoramic camera.
void focus_at(State& state, const Vec3& point) {
  CameraPose placed = current_camera(state);
  const Vec3 to_point = point - Vec3(placed.to_world[3]);
  const float depth =
      placed.camera.projection == Projection::panoramic ? glm::length(to_point) : depth_of(placed, point);
  if (!(depth > 0)) return state.notify("cannot focus on a point behind the camera");
  placed.camera.focus_distance = depth;
  state.document->set_camera(placed);
  state.touch();
}

std::filesystem::path free_name(const std::string& document, const std::string& extension) {
  const std::string scene = std::filesystem::path(document).stem().string();
  std::error_code failure;
  for (int number = 1;; ++number) {
    std::filesystem::path file = fmt::format("relume-{}-{:04d}{}", scene, number, extension);
    if (!std::filesystem::exists(file, failure)) return file;
  }
}

/// `name` is called when the image is written, so that two requests for the same frame get different names.
void post_image(State& state, std::function<std::filesystem::path()> name) {
  AllSettings shown = state.settings[0];
  shown.output.exposure = shown.output.exposure.value_or(state.automatic_exposure[0]);
  state.renderer->post_task([name = std::move(name), settings = std::move(shown), renderer = state.renderer,
                             ocio = state.ocio.view()](const Session& session, const LoadedScene& scene) {
    const std::filesystem::path file = name();
    std::vector<std::string> aovs;
    if (lower_extension(file) == ".exr") aovs = Session::aov_names(render_settings(session));
    const cli::Metadata metadata = cli::image_metadata(session, scene.name, settings, scene.load_s);
    const Display display = display_for(settings.output, session.image().pixels, session.in_studio());
    cli::write_image(file, session, display, aovs, metadata, ocio.get());
    const std::string samples = cli::format_samples(session.kept_samples());
    renderer->add_notice({false, fmt::format("wrote {} at {} samples per pixel", file.string(), samples)});
  });
}

}  // namespace

void move_sun(const State& state, SunSky& sky) {
  const SunPosition sun = sun_position(state.sun_hour, state.sun_day, glm::radians(state.latitude_deg));
  sky.sun_elevation_rad = sun.elevation_rad;
  sky.sun_azimuth_rad = sun.azimuth_rad;
}

void add_bookmark(State& state) { store_bookmark(state, state.bookmarks.size()); }

void store_bookmark(State& state, size_t slot) {
  if (!state.has_camera()) return state.notify(kNoCamera, true);
  slot = std::min(slot, state.bookmarks.size());
  const Bookmark bookmark{fmt::format("View {}", slot + 1), current_view(state)};
  if (slot == state.bookmarks.size()) {
    state.bookmarks.push_back(bookmark);
  } else {
    state.bookmarks[slot] = bookmark;
  }
  save_bookmarks(state);
  state.notify(fmt::format("stored as view {}", slot + 1));
}

void go_to_bookmark(State& state, size_t slot) {
  if (slot >= state.bookmarks.size())
    return state.notify(fmt::format("no view {}; store one with Ctrl and a digit", slot + 1));
  if (!state.has_camera()) return state.notify(kNoCamera, true);
  set_view(state, state.bookmarks[slot].view);
}

void toggle_recording(State& state) {
  PathTools& tools = state.path;
  if (tools.recording) {
    tools.recording = false;
    return state.notify(fmt::format("recorded {:.1f} s; Ctrl+S saves the path", tools.path.duration_s()));
  }
  tools.path.clear();
  tools.playing = false;
  tools.recording = true;
  tools.since_s = state.now_s;
  state.notify("recording the camera");
}

void toggle_path(State& state) {
  state.path.playing = !state.path.playing && state.path.path.keys().size() > 1;
  state.path.recording = false;
  state.path.since_s = state.now_s;
}

void add_path_key(State& state) {
  if (!state.has_camera()) return state.notify(kNoCamera, true);
  PathTools& tools = state.path;
  const Viewpoint view = current_view(state);
  float time = tools.path.keys().empty() ? 0 : tools.path.duration_s() + tools.spacing_s;
  if (tools.recording && time > 0) time = static_cast<float>(state.now_s - tools.since_s);
  tools.path.add({time, view.eye, view.rotation});
  state.notify(fmt::format("key {} at {:.1f} s", tools.path.keys().size(), time));
}

void update_path(State& state) {
  PathTools& tools = state.path;
  const auto time = static_cast<float>(state.now_s - tools.since_s);
  if (tools.recording && state.has_camera()) {
    const bool due =
        tools.path.keys().empty() || time - tools.path.duration_s() >= static_cast<float>(kRecordInterval_s);
    const Viewpoint view = current_view(state);
    if (due) tools.path.add({tools.path.keys().empty() ? 0 : time, view.eye, view.rotation});
  }
  if (!tools.playing) return;
  const PathKey key = tools.path.at(time);
  set_view(state, {key.eye, key.rotation, current_view(state).fov_y_rad});
  if (time >= tools.path.duration_s()) tools.playing = false;
}

void update_animation(State& state, double seconds) {
  if (!state.animating || !state.document) return;
  const float end = state.document->duration_s();
  if (!(end > 0)) {
    state.animating = false;
    return state.notify("this scene has no animation");
  }
  set_scene_time(state, std::fmod(state.document->time_s() + static_cast<float>(seconds), end));
}

void check_not_read(const State& state, const std::filesystem::path& file) {
  const auto target = cli::file_number(file.string());
  if (!target) return;  // does not exist
  std::vector<std::filesystem::path> sources = state.document->loaded()->scene.source_files;
  for (const AllSettings& side : state.settings) sources.emplace_back(side.scene.env);
  if (state.loading.valid()) sources.emplace_back(state.loading_name);
  for (const std::filesystem::path& source : sources) {
    if (cli::file_number(source.string()) == target)
      throw Error(
          fmt::format("{} would be replaced, but the scene is read from it; choose another name", file.string()));
  }
}

void save_image(State& state, const std::filesystem::path& file) {
  check_not_read(state, file);
  post_image(state, [file] { return file; });
}

void save_numbered_image(State& state, const std::string& extension) {
  post_image(state, [document = state.document->name(), extension] { return free_name(document, extension); });
}

void write_view_file(State& state, const std::filesystem::path& file) {
  if (!state.has_camera()) throw Error(kNoCamera);
  check_not_read(state, file);
  const auto omissions = save_view(file, {*state.document, state.settings[0], current_camera(state), &state.path.path,
                                          state.ocio.view() != nullptr});
  state.notify("wrote " + file.string());
  for (const std::string& omission : omissions) state.notify(omission, true);
}

void save_view_file(State& state, const std::filesystem::path& file) {
  try {
    write_view_file(state, file);
  } catch (const std::exception& error) {
    state.notify(error.what(), true);
  }
}

void save_numbered_view_file(State& state) { save_view_file(state, free_name(state.document->name(), ".json")); }

void pick_at(State& state, const Vec2& point, bool focus) {
  auto promise = std::make_shared<std::promise<PickResult>>();
  state.picked = promise->get_future();
  state.pick_focuses = focus;
  state.renderer->post_task([promise, point](const Session& session, const LoadedScene& scene) {
    PickResult result = pick(session, point);
    result.scene = &scene;
    promise->set_value(result);
  });
}

void show_directions_at(State& state, const Vec2& point) {
  if (state.settings[0].render.guide != GuideChoice::cdq)
    return state.notify("directions are recorded only with guide 'cdq'; choose it in the settings");
  change_setting(state, 0, "cdq.view", "on");
  change_setting(state, 0, "cdq.view-x", std::to_string(point.x));
  change_setting(state, 0, "cdq.view-y", std::to_string(point.y));
  state.buffer = "directions";
  state.touch();
}

void finish_pick(State& state) {
  if (!state.picked.valid() || state.picked.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  PickResult result;
  try {
    result = state.picked.get();
  } catch (const std::future_error&) {
    return;  // the rendering thread ended first
  }
  if (result.scene != state.document->loaded().get()) return;  // the scene has changed since
  if (!result.hit) {
    if (!state.pick_focuses) state.selection = {};
  } else if (state.pick_focuses) {
    focus_at(state, result.position);
  } else if (static_cast<size_t>(result.node) < state.document->outline().nodes.size()) {
    select(state, {Selected::node, result.node});
    state.panel = Panel::scene;
    state.panel_wanted = true;
  }
}

void select(State& state, const Selection& selection) {
  state.selection = selection;
  const Index node = selected_node(state);
  if (node == kNone || !state.document->make_movable(node)) return;
  state.notify("compiling the scene to make the selection movable");
  state.touch();
}

Index selected_node(const State& state) {
  const Selection& selection = state.selection;
  if (selection.kind == Selected::node) return state.document->mover(selection.index).node;
  return selection.kind == Selected::light ? state.document->node_of_light(selection.index) : kNone;
}

void drag_selection(State& state, const Vec2& delta) {
  if (state.selection.kind == Selected::node) {
    if (const Mover mover = state.document->mover(state.selection.index); mover.node == kNone)
      return state.notify(mover.problem, true);
  }
  const CameraPose camera = current_camera(state);
  const float depth = selection_depth(state, camera);
  if (!(depth > 0)) return;
  const float height = view_height(camera.camera, depth);
  const Vec3 right = glm::normalize(Vec3(camera.to_world[0]));
  const Vec3 up = glm::normalize(Vec3(camera.to_world[1]));
  state.document->move(selected_node(state), (right * delta.x - up * delta.y) * height);
  state.touch();
}

}  // namespace relume::viewer
