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
      script_(std::move(script)),
      loop_(state_, renderer_) {
  state_.renderer = &renderer_;
  renderer_.on_frame([this] { window_.hurry(); });
  renderer_.keep_images_on_device(true);
  state_.settings = {settings, settings};
  state_.ocio = std::move(ocio);
  state_.follow_window = !fixed_size;
  state_.resolution_policy.target_hz = options.target_hz;
  state_.watches = options.watch;
  state_.now_s = now_s();
  show_document(state_, std::move(scene), true);
}

void App::run() {
  // The images of tests and scripts do not depend on when the table is ready.
  if (smoke_ || !options_.script.empty() || !options_.screenshot.empty()) state_.ocio.table();
  loop_.start(now_s());
  while (!window_.should_close() && !finished()) {
    frame();
    if (!loop_.device_loss().empty()) throw Error(ErrorCode::device, loop_.device_loss());
    if (!state_.frame() && !loop_.first_problem().empty()) throw Error(loop_.first_problem());
    if (smoke_ && now_s() - loop_.newest_frame_s() > kPatience_s)
      throw Error("no frame was rendered for five minutes; reduce --width and --height, or run on an idle machine");
  }
  finish();
}

bool App::finished() const {
  if (!smoke_ || !script_.done() || state_.loading.valid() || !state_.frame()) return false;
  return state_.frame()->serial >= static_cast<uint64_t>(options_.smoke) || state_.reached_goals(loop_.version());
}

void App::frame() {
  const double interval_s = std::clamp(window_.drawing_s() / kDrawingShare, 1 / kFastest_hz, 1 / kSlowest_hz);
  window_.begin_frame(interval_s, [this] { take_input(); });
  const std::string name = state_.document ? state_.document->name() : "";
  loop_.begin_frame(now_s());
  for (const std::string& file : window_.take_dropped_files()) open_scene(state_, file);
  loop_.advance();
  if (state_.document && state_.document->name() != name) window_.set_title("relume " + state_.document->name());
  viewport_.update(state_);
  draw();
  handle_keys(state_, viewport_.image().size.y);
  loop_.post();
  window_.end_frame(viewport_.version());
  loop_.monitor().interface_frame(now_s());
  if (screenshot_.empty()) return;
  window_.save(std::exchange(screenshot_, {}));
  loop_.monitor().interrupt();
}

void App::take_input() {
  script_.update(
      {.frames = [this] { return state_.frame() ? state_.frame()->serial : 0; },
       .request = [this] { return loop_.version(); },
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
