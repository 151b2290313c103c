// Text and loupe over the image.
#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>

#include "cli/reports.h"
#include "viewer/model/preparation_lines.h"
#include "viewer/panels/theme.h"
#include "viewer/render/inspect.h"
#include "viewer/viewport.h"

namespace relume::viewer {
namespace {

/// Text on a dark background.
void label(ImDrawList& list, const ImVec2& at, const std::string& text, ImU32 color = IM_COL32(230, 232, 238, 255)) {
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  list.AddRectFilled({at.x - 8, at.y - 5}, {at.x + size.x + 8, at.y + size.y + 5}, kOverlay, 5);
  list.AddText(at, color, text.c_str());
}

/// The frame under the mouse: B's to the right of the line.
const ViewerFrame* frame_at(const State& state, const Vec2& point) {
  const bool second = state.split && point.x > state.split_at && state.frames[1];
  return state.frames[second ? 1 : 0].get();
}

std::string status_of(const State& state, const ViewerFrame& frame) {
  const int percent = static_cast<int>(std::lround(100.0 * frame.width / std::max(frame.full_width, 1)));
  std::string text = fmt::format("{}x{}", frame.width, frame.height);
  if (percent < 100) text += fmt::format(" ({} %)", percent);
  if (frame.upscale > 1) text += ", upscaled";
  const std::string samples = cli::format_samples(frame.samples);
  text += fmt::format("  \xc2\xb7  {} sample{} per pixel  \xc2\xb7  {:.1f} frames/s", samples,
                      samples == "1" ? "" : "s", state.frames_per_s);
  if (state.paused) text += "  \xc2\xb7  paused";
  if (frame.reached_goal) text += "  \xc2\xb7  done";
  if (!frame.buffer.empty()) text += "  \xc2\xb7  " + frame.buffer;
  return text;
}

}  // namespace

void Viewport::draw_overlay(const State& state) const {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float line = ImGui::GetFontSize() + 14;
  ImVec2 at(image_.at.x + 18, image_.at.y + 16);
  if (const ViewerFrame* frame = state.frame()) {
    label(list, at, status_of(state, *frame));
    at.y += line;
  }
  for (const std::string& text : preparation_lines(state)) {
    label(list, at, text, kAccent);
    at.y += line;
  }
  if (state.path.recording) {
    label(list, at, fmt::format("recording {:.1f} s", state.now_s - state.path.since_s), kProblem);
  }
  float y = image_.end().y - 20 - line;
  for (auto toast = state.toasts.rbegin(); toast != state.toasts.rend(); ++toast) {
    label(list, {image_.at.x + 18, y}, toast->text, toast->problem ? kProblem : IM_COL32(230, 232, 238, 255));
    y -= line;
  }
}

std::string Viewport::describe_under_mouse(const State& state) const {
  const ViewerFrame* frame = frame_at(state, point_under_mouse());
  if (!frame || !image_.contains(ImGui::GetIO().MousePos)) return {};
  return describe_pixel(*frame, point_under_mouse());
}

void Viewport::draw_values() const {
  ImGui::PushFont(monospace_font());
  const float width = ImGui::CalcTextSize(under_mouse_.c_str()).x;
  label(*ImGui::GetWindowDrawList(), {image_.end().x - width - 18, image_.at.y + 16}, under_mouse_);
  ImGui::PopFont();
}

void Viewport::draw_loupe(const State& state) const {
  const Vec2 point = point_under_mouse();
  const ViewerFrame* frame = frame_at(state, point);
  if (!frame) return;
  const GlImage& image = images_[frame == state.frames[0].get() ? 0 : 1];
  constexpr float kSide_px = 220;
  const float pixels = kSide_px / static_cast<float>(state.inspector.loupe_zoom);
  const Vec2 half = 0.5f * pixels / Vec2(frame->width, frame->height);
  // The view moves by whole pixels with the mouse.
  const Vec2 center =
      (glm::floor(point * Vec2(frame->width, frame->height)) + 0.5f) / Vec2(frame->width, frame->height);
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  ImVec2 at(mouse.x + 24, mouse.y + 24);
  if (at.x + kSide_px > image_.end().x) at.x = mouse.x - 24 - kSide_px;
  if (at.y + kSide_px > image_.end().y) at.y = mouse.y - 24 - kSide_px;
  const ImVec2 end(at.x + kSide_px, at.y + kSide_px);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled({at.x - 3, at.y - 3}, {end.x + 3, end.y + 3}, kOverlay, 4);
  list.AddCallback(bind_sampler, as_callback_data(display_shader_.nearest_sampler()));
  list.AddImage(as_texture(image.texture()), at, end, {center.x - half.x, center.y - half.y},
                {center.x + half.x, center.y + half.y});
  list.AddCallback(ImDrawCallback_ResetRenderState, nullptr);
  const float side = static_cast<float>(state.inspector.loupe_zoom);
  const ImVec2 middle(0.5f * (at.x + end.x), 0.5f * (at.y + end.y));
  list.AddRect({middle.x - 0.5f * side - 1, middle.y - 0.5f * side - 1},
               {middle.x + 0.5f * side + 1, middle.y + 0.5f * side + 1}, kAccent);
}

void draw_help(State& state) {
  if (!state.show_help) return;
  constexpr std::pair<const char*, const char*> kKeys[] = {
      {"drag", "orbit, or look around (O switches)"},
      {"right drag, Shift + drag", "move parallel to the image"},
      {"wheel", "orbit: nearer or farther; fly: speed"},
      {"W A S D, Q E", "fly; Shift: faster"},
      {"F", "frame the selection, or the whole scene"},
      {"O", "orbit or fly"},
      {"click", "select the object or light under the mouse"},
      {"Alt + click", "directions that guiding stores at this point"},
      {"Ctrl + drag", "move the selection"},
      {"Ctrl + Shift + click", "focus at the point"},
      {"Home", "the scene's camera"},
      {"Escape", "close a list or this one, clear the selection"},
      {"1 ... 9", "go to a bookmark; with Ctrl: store it"},
      {"R, K", "record a new camera path; add a key"},
      {"Space, P", "pause rendering; play the animation"},
      {"B", "compare A and B"},
      {"L", "loupe"},
      {"[ ]", "exposure"},
      {"F12", "image as PNG; with Shift: as EXR"},
      {"Ctrl + S", "view as relume JSON"},
      {"Tab, F1", "panels; this list"},
  };
  ImGui::SetNextWindowPos({ImGui::GetIO().DisplaySize.x * 0.5f, ImGui::GetIO().DisplaySize.y * 0.45f}, ImGuiCond_Always,
                          {0.5f, 0.5f});
  ImGui::Begin("Keys", &state.show_help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoCollapse);
  for (const auto& [key, meaning] : kKeys) {
    ImGui::PushStyleColor(ImGuiCol_Text, kAccent);
    ImGui::TextUnformatted(key);
    ImGui::PopStyleColor();
    ImGui::SameLine(ImGui::GetFontSize() * 13);
    ImGui::TextUnformatted(meaning);
  }
  ImGui::End();
}

}  // namespace relume::viewer
