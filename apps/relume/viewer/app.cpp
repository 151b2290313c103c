#include "viewer/app.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/clock.h"
#include "relume/error.h"
#include "viewer/imgui_input.h"
#include "viewer/model/actions.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/settings_panel.h"
#include "viewer/panels/theme.h"

namespace relume::viewer {
namespace {

constexpr double kFastest_hz = 60;
constexpr double kSlowest_hz = 36;     // minimum rate for slow drawing; with a margin above 30
constexpr double kDrawingShare = 0.5;  // maximum share of the time, unless below the minimum rate
constexpr double kNumbers_s = 0.5;     // interval at which displayed rates change, to be readable
constexpr float kSidebar_px = 390;
constexpr float kTiming_px = 148;
constexpr double kPatience_s = 300;  // until smoke tests fail without a frame, compilation of a scene included

/// A window with room for an image of the requested size, within common screen sizes.
IVec2 window_size(const AllSettings& settings, bool fixed_size) {
  if (!fixed_size) return {1440, 900};
  return {std::clamp(settings.render.width + static_cast<int>(kSidebar_px), 960, 1920),
          std::clamp(settings.render.height + static_cast<int>(kTiming_px), 600, 1200)};
}

}  // namespace

App::App(const cli::ViewOptions& options, const AllSettings& settings, bool fixed_size, ScriptPlayer script,
         std::shared_ptr<const LoadedScene> scene, OcioDisplay ocio)
    : options_(options),
      smoke_(options.smoke > 0),
      window_(window_size(settings, fixed_size).x, window_size(settings, fixed_size).y, "relume " + scene->name,
              !smoke_),
      script_(std::move(script)) {
  state_.renderer = &renderer_;
  renderer_.on_frame([this] { window_.hurry(); });
  state_.settings = {settings, settings};
  state_.ocio = std::move(ocio);
  state_.follow_window = !fixed_size;
  state_.resolution_policy.target_hz = options.target_hz;
  state_.watches = options.watch;
  state_.now_s = now_s();
  show_document(state_, std::move(scene), true);
  last_s_ = state_.now_s;
}

void App::run() {
  // The images of tests and scripts do not depend on when the table is ready.
  if (smoke_ || !options_.script.empty() || !options_.screenshot.empty()) state_.ocio.table();
  newest_frame_s_ = now_s();
  while (!window_.should_close() && !finished()) {
    frame();
    if (!device_loss_.empty()) throw Error(ErrorCode::device, device_loss_);
    if (!state_.frame() && !first_problem_.empty()) throw Error(first_problem_);
    if (smoke_ && now_s() - newest_frame_s_ > kPatience_s)
      throw Error("no frame was rendered for five minutes; reduce --width and --height, or run on an idle machine");
  }
  finish();
}

bool App::finished() const {
  if (!smoke_ || !script_.done() || state_.loading.valid() || !state_.frame()) return false;
  return state_.frame()->serial >= static_cast<uint64_t>(options_.smoke) || state_.reached_goals(version_);
}

void App::frame() {
  const double interval_s = std::clamp(window_.drawing_s() / kDrawingShare, 1 / kFastest_hz, 1 / kSlowest_hz);
  window_.begin_frame(interval_s, [this] { take_input(); });
  state_.now_s = now_s();
  const double passed_s = std::min(state_.now_s - last_s_, 0.1);
  last_s_ = state_.now_s;
  std::erase_if(state_.toasts, [&](const Toast& toast) { return toast.until_s < state_.now_s; });
  const std::string name = state_.document ? state_.document->name() : "";
  take_frames();
  take_notices();
  for (const std::string& file : window_.take_dropped_files()) open_scene(state_, file);
  follow_files(state_);
  finish_loading(state_);
  if (state_.document && state_.document->name() != name) window_.set_title("relume " + state_.document->name());
  finish_pick(state_);
  update_animation(state_, passed_s);
  update_path(state_);
  viewport_.update(state_);
  draw();
  handle_keys(state_, viewport_.image().size.y);
  post();
  window_.end_frame(viewport_.version());
  monitor_.interface_frame(now_s());
  if (screenshot_.empty()) return;
  window_.save(std::exchange(screenshot_, {}));
  monitor_.interrupt();
}

void App::take_input() {
  script_.update(
      {.frames = [this] { return state_.frame() ? state_.frame()->serial : 0; },
       .request = [this] { return version_; },
       .first_frame_following = [this](uint64_t version) { return renderer_.first_frame_following(version); },
       .now_s = now_s,
       .loading = [this] { return state_.loading.valid(); },
       .act = [this](const ScriptStep& step) { act(step); }});
  const ScriptedInput& input = script_.input();
  if (options_.script.empty()) return;
  hold_keys(input.keys);
  if (!input.mouse) return;
  const Rect& image = viewport_.image();
  hold_mouse({image.at.x + input.point.x * image.size.x, image.at.y + input.point.y * image.size.y}, input.left,
             input.wheel);
}

void App::take_frames() {
  for (int side = 0; side < kSides; ++side) {
    const auto s = static_cast<size_t>(side);
    if (side >= state_.sides()) {
      state_.frames[s].reset();
      state_.times[s] = {};
      continue;
    }
    std::shared_ptr<const ViewerFrame> frame = renderer_.frame(side);
    if (!frame || (state_.frames[s] && frame->serial == state_.frames[s]->serial)) continue;
    state_.frames[s] = std::move(frame);
    state_.times[s].add(*state_.frames[s]);
    if (side > 0) continue;
    monitor_.rendered_frame(state_.now_s);
    newest_frame_s_ = state_.now_s;
    if (state_.document) choose_mode(state_);
    if (state_.frame()->request_version >= release_version_) state_.awaits_camera = false;
  }
  const auto shows_document = [&](const auto& frame) { return frame && frame->scene == state_.document->loaded(); };
  if (state_.document && std::all_of(state_.frames.begin(), state_.frames.begin() + state_.sides(), shows_document))
    state_.previous.reset();
  for (; !camera_moves_.empty(); camera_moves_.pop_front()) {
    const uint64_t seen = renderer_.first_frame_following(camera_moves_.front().first);
    if (seen == 0) break;
    monitor_.camera_seen(seen - camera_moves_.front().second);
  }
  if (state_.now_s - numbers_s_ < kNumbers_s) return;
  numbers_s_ = state_.now_s;
  state_.frames_per_s = monitor_.frames_per_s();
  state_.interface_hz = monitor_.interface_hz();
}

void App::take_notices() {
  for (const Notice& notice : renderer_.take_notices()) {
    if (notice.problem && first_problem_.empty()) first_problem_ = notice.text;
    if (notice.failed_task && failed_task_.empty()) failed_task_ = notice.text;
    if (notice.device_lost && device_loss_.empty()) device_loss_ = notice.text;
    state_.notify(notice.text, notice.problem);
    if (notice.refused_scene && state_.document && notice.refused_scene == state_.document->loaded())
      revert_document(state_);
  }
}

void App::post() {
  if (!state_.request_changed || !state_.document) return;
  if (state_.image_changed) ++image_version_;
  state_.request_changed = state_.image_changed = false;
  const uint64_t camera = state_.document->edits().camera.version;
  ++version_;
  if (std::exchange(state_.camera_released, false)) {
    state_.awaits_camera = true;
    release_version_ = version_;
  }
  const auto newest = renderer_.frame(0);  // may be newer than the displayed one
  if (camera != camera_version_ && newest) camera_moves_.emplace_back(version_, newest->serial);
  camera_version_ = camera;
  state_.navigation.pace.posted(version_);
  renderer_.post(make_request(state_, version_, image_version_));
}

void App::draw_tabs() {
  constexpr std::pair<const char*, Panel> kTabs[] = {
      {"Settings", Panel::settings}, {"Scene", Panel::scene}, {"Camera", Panel::camera}, {"Buffers", Panel::buffers}};
  if (!ImGui::BeginTabBar("panels")) return;
  const bool wanted = std::exchange(state_.panel_wanted, false);
  for (const auto& [title, panel] : kTabs) {
    const bool now = wanted && state_.panel == panel;
    if (!ImGui::BeginTabItem(title, nullptr, now ? ImGuiTabItemFlags_SetSelected : 0)) continue;
    if (!wanted) state_.panel = panel;
    if (panel == Panel::settings) draw_settings_panel(state_);
    if (panel == Panel::scene) draw_scene_panel(state_);
    if (panel == Panel::camera) draw_camera_panel(state_);
    if (panel == Panel::buffers) draw_buffers_panel(state_);
    ImGui::EndTabItem();
  }
  ImGui::EndTabBar();
}

void App::draw() {
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  const float scale = window_.content_scale();
  const float sidebar = state_.show_panels ? std::min(kSidebar_px * scale, 0.5f * size.x) : 0;
  const float timing = state_.show_panels ? std::min(kTiming_px * scale, 0.3f * size.y) : 0;
  constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                                      ImGuiWindowFlags_NoBringToFrontOnFocus | ImGuiWindowFlags_NoSavedSettings |
                                      ImGuiWindowFlags_NoNav;
  const auto begin = [&](const char* name, const ImVec2& at, const ImVec2& extent, ImGuiWindowFlags more = 0) {
    ImGui::SetNextWindowPos(at);
    ImGui::SetNextWindowSize(extent);
    ImGui::Begin(name, nullptr, kFixed | more);
  };
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {0, 0});
  begin("viewport", {0, 0}, {size.x - sidebar, size.y - timing}, ImGuiWindowFlags_NoBackground);
  viewport_.draw(state_, {{0, 0}, {size.x - sidebar, size.y - timing}});
  ImGui::End();
  ImGui::PopStyleVar();
  if (state_.show_panels) {
    begin("sidebar", {size.x - sidebar, 0}, {sidebar, size.y});
    draw_tabs();
    ImGui::End();
    begin("timing", {0, size.y - timing}, {size.x - sidebar, timing});
    draw_timing_panel(state_, state_.edited_side);
    ImGui::End();
  }
  draw_help(state_);
}

}  // namespace relume::viewer
