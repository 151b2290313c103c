// Actions of scripts, and the report at the end of a smoke test.
#include <algorithm>
#include <cstdio>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"
#include "viewer/app.h"
#include "viewer/model/actions.h"
#include "viewer/render/frame_pixels.h"

namespace relume::viewer {
namespace {

/// Index of the item of that name in one of the scene's lists.
template <typename Items>
Index index_of(const Items& items, const char* kind, const std::string& name) {
  const auto found = std::find_if(items.begin(), items.end(), [&](const auto& item) { return item.name == name; });
  if (found == items.end())
    throw Error(std::string("the scene has no ") + kind + " '" + name + "'; the panel Scene lists the names");
  return static_cast<Index>(found - items.begin());
}

void choose_panel(State& state, const std::string& name) {
  constexpr const char* kNames[] = {"settings", "scene", "camera", "buffers"};
  for (int i = 0; i < 4; ++i) {
    if (name != kNames[i]) continue;
    state.panel = static_cast<Panel>(i);
    state.panel_wanted = true;
    return;
  }
  throw Error("there is no panel '" + name + "'; use settings, scene, camera or buffers");
}

void set_sun(State& state, float hour) {
  Environment e = state.document->outline().environment;
  if (e.kind != EnvironmentKind::sun_sky)
    throw Error("the environment has no sun; start the viewer with --env sun_sky");
  state.sun_hour = hour;
  move_sun(state, e.sun_sky);
  state.document->set_environment(e);
  state.touch();
}

/// Multiplies the emission of the selected light or material.
void emit(State& state, float factor) {
  const Selection& s = state.selection;
  if (s.kind == Selected::light) {
    PunctualLight light = state.document->outline().lights[static_cast<size_t>(s.index)];
    light.intensity *= factor;
    state.document->set_light(s.index, light);
  } else if (s.kind == Selected::material) {
    Material material = state.document->outline().materials[static_cast<size_t>(s.index)];
    material.emission *= factor;
    state.document->set_material(s.index, material);
  } else {
    throw Error("no light or material is selected; select one in an earlier step");
  }
  state.touch();
}

double mean_luminance(const ViewerFrame& frame) {
  const std::vector<Rgb> radiance = radiance_of(frame);
  double sum = 0;
  for (const Rgb& c : radiance) sum += static_cast<double>(luminance(c));
  return sum / static_cast<double>(std::max<size_t>(radiance.size(), 1));
}

nlohmann::json frame_report(const ViewerFrame& frame) {
  nlohmann::json result = {{"frames", frame.serial},           {"width", frame.width},
                           {"height", frame.height},           {"samples", frame.samples},
                           {"buffer", frame.buffer},           {"time_s", frame.time_s},
                           {"frame_ms", frame.seconds * 1000}, {"mean_luminance", mean_luminance(frame)}};
  for (const PassTime& pass : frame.passes) result["pass_ms"][pass.name] = pass.seconds * 1000;
  for (const AovLayer& buffer : frame.buffers) result["buffers"].push_back(buffer.name);
  return result;
}

/// Flushes each line, so that readers of a pipe follow the script.
void print(const std::string& line) {
  std::puts(line.c_str());
  std::fflush(stdout);
}

}  // namespace

void App::act_on_scene(const ScriptStep& step) {
  const std::string& word = step.words[0];
  const Scene& scene = state_.document->outline();
  if (step.verb == "select") {
    if (word == "node")
      select(state_, {Selected::node, index_of(scene.nodes, "node", step.words[1])});
    else if (word == "light")
      select(state_, {Selected::light, index_of(scene.lights, "light", step.words[1])});
    else if (word == "material")
      select(state_, {Selected::material, index_of(scene.materials, "material", step.words[1])});
    else
      throw Error("'" + word + "' cannot be selected; use node, light or material");
  }
  if (step.verb == "sun") set_sun(state_, number_in(word));
  if (step.verb == "emit") emit(state_, number_in(word));
}

void App::act(const ScriptStep& step) {
  const std::vector<std::string>& w = step.words;
  if (step.verb == "set") change_setting(state_, 0, w[0], w[1]);
  if (step.verb == "try") {
    try {
      change_setting(state_, 0, w[0], w[1]);
    } catch (const Error& error) {
      state_.notify(error.what(), true);
    }
  }
  if (step.verb == "set-b") change_setting(state_, 1, w[0], w[1]);
  if (step.verb == "preset") apply_preset(state_, 0, w[0]);
  if (step.verb == "preset-b") apply_preset(state_, 1, w[0]);
  if (step.verb == "panel") choose_panel(state_, w[0]);
  if (step.verb == "drop") open_scene(state_, w[0]);
  if (step.verb == "save") save_image(state_, w[0]);
  if (step.verb == "save-view") write_view_file(state_, w[0]);
  if (step.verb == "screenshot") {
    check_not_read(state_, w[0]);
    screenshot_ = w[0];
  }
  if (step.verb == "play") toggle_path(state_);
  if (step.verb == "search") state_.setting_query = w[0];
  if (step.verb == "report") print(report());
  if (step.verb == "buffer") {
    state_.buffer = w[0] == "image" ? "" : w[0];
    state_.request_changed = true;
  }
  if (step.verb == "split") {
    if (w[0] != "on" && w[0] != "off") throw Error("split is '" + w[0] + "'; use on or off");
    set_split(state_, w[0] == "on");
  }
  if (step.verb == "pace") {
    if (w[0] != "on" && w[0] != "moving" && w[0] != "off") throw Error("pace is '" + w[0] + "'; use on, moving or off");
    state_.resolution_policy.hold_rate = w[0] != "off";
    state_.resolution_policy.full_at_rest = w[0] != "moving";
    state_.request_changed = true;
    loop_.monitor().reset();
  }
  if (step.verb == "select" || step.verb == "sun" || step.verb == "emit") act_on_scene(step);
}

std::string App::report() const {
  using nlohmann::json;
  const Viewpoint view = current_view(state_);
  const Vec3 forward = view.rotation * Vec3(0, 0, -1);
  json result = {{"scene", state_.document->name()},
                 {"interface_hz", loop_.monitor().interface_hz()},
                 {"longest_gap_ms", loop_.monitor().longest_gap_s() * 1000},
                 {"frames_per_s", loop_.monitor().frames_per_s()},
                 {"camera_latency_frames", loop_.monitor().camera_latency_frames()},
                 {"eye", {view.eye.x, view.eye.y, view.eye.z}},
                 {"forward", {forward.x, forward.y, forward.z}},
                 {"bookmarks", state_.bookmarks.size()},
                 {"path_keys", state_.path.path.keys().size()},
                 {"selected", static_cast<int>(state_.selection.kind)},
                 {"selected_index", state_.selection.index},
                 {"paused", state_.paused},
                 {"split", state_.split},
                 {"split_at", state_.split_at},
                 {"recording", state_.path.recording},
                 {"playing", state_.path.playing},
                 {"animating", state_.animating},
                 {"clips", state_.document->outline().clips},
                 {"animation_s", state_.document->duration_s()},
                 {"path_s", state_.path.path.duration_s()},
                 {"speed", state_.fly.speed},
                 {"orbits", state_.navigation.mode == CameraMode::orbit},
                 {"focus_m", current_camera(state_).camera.focus_distance},
                 {"under_mouse", viewport_.values_under_mouse()},
                 {"exposure", state_.settings[0].output.exposure.value_or(state_.automatic_exposure[0])}};
  if (const Index node = selected_node(state_); node != kNone) {
    const Mat4& world = state_.document->world()[static_cast<size_t>(node)];
    result["selected_at"] = {world[3].x, world[3].y, world[3].z};
  }
  if (const auto worst = loop_.monitor().worst_interface_hz()) result["worst_interface_hz"] = *worst;
  for (const Toast& toast : state_.toasts) result["messages"].push_back(toast.text);
  AllSettings settings = state_.settings[0];
  for (const Setting& slot : describe_slots(settings.render)) result["slots"][slot.name] = to_string(slot);
  result["graph_frames"] = state_.times[0].entries.size();
  if (state_.frame()) result.update(frame_report(*state_.frame()));
  if (state_.split && state_.frames[1]) result["mean_luminance_b"] = mean_luminance(*state_.frames[1]);
  return result.dump();
}

void App::finish() {
  if (!options_.screenshot.empty()) window_.save(options_.screenshot);
  const bool told = !loop_.failed_task().empty();
  renderer_.stop();
  loop_.take_notices();
  if (smoke_) print(report());
  // The window has already shown the error; scripts, and images written after the window closed, still need it.
  if (!loop_.failed_task().empty() && (!told || !options_.script.empty())) throw Error(loop_.failed_task());
}

}  // namespace relume::viewer
