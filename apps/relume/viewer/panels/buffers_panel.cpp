#include <algorithm>

#include <fmt/format.h>
#include <imgui/imgui.h>

#include "viewer/panels/panels.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"
#include "viewer/render/inspect.h"

namespace relume::viewer {
namespace {

void draw_choice(State& state) {
  ImGui::BeginChild("list", {0, ImGui::GetContentRegionAvail().y * 0.5f});
  if (ImGui::Selectable("image", state.buffer.empty())) {
    state.buffer.clear();
    state.request_changed = true;
  }
  tooltip("Accumulated mean radiance, exposed and tone-mapped");
  if (state.frame()) {
    for (const AovLayer& buffer : state.frame()->buffers) {
      if (ImGui::Selectable(buffer.name.c_str(), state.buffer == buffer.name)) {
        state.buffer = buffer.name;
        state.inspector.automatic = true;
        state.request_changed = true;
      }
      tooltip(buffer.help);
    }
  }
  ImGui::EndChild();
}

void draw_palette(const Vec2& range) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x;
  const float height = ImGui::GetFontSize();
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const Rgb c = palette_color((static_cast<float>(i) + 0.5f) / kSteps);
    const float step = width / kSteps;
    ImGui::GetWindowDrawList()->AddRectFilled({at.x + step * static_cast<float>(i), at.y},
                                              {at.x + step * static_cast<float>(i + 1) + 1, at.y + height},
                                              ImGui::ColorConvertFloat4ToU32({c.r, c.g, c.b, 1}));
  }
  ImGui::Dummy({width, height});
  const std::string low = fmt::format("{:.4g}", range.x);
  const std::string high = fmt::format("{:.4g}", range.y);
  ImGui::TextUnformatted(low.c_str());
  ImGui::SameLine(width - ImGui::CalcTextSize(high.c_str()).x);
  ImGui::TextUnformatted(high.c_str());
}

void draw_display(State& state) {
  Inspector& inspector = state.inspector;
  DisplayTransform& d = inspector.display_transform;
  ImGui::Checkbox("Automatic", &inspector.automatic);
  tooltip("Chooses colours and range for the buffer; the range is the 1st to 99th percentile");
  constexpr const char* kModes[] = {"radiance", "colour in range", "false colour", "direction"};
  int mode = static_cast<int>(d.mode);
  if (ImGui::Combo("display as", &mode, kModes, 4)) {
    d.mode = static_cast<DisplayMode>(mode);
    inspector.automatic = false;
  }
  if (d.mode == DisplayMode::false_color) {
    const std::string channels = state.frame() ? state.frame()->channels : "";
    int choice = d.channel + 1;
    std::string items = "length";
    for (const char c : channels) items += std::string(1, '\0') + c;
    items += '\0';
    if (ImGui::Combo("channel", &choice, items.c_str())) {
      d.channel = choice - 1;
      inspector.automatic = false;
    }
  }
  if (d.mode == DisplayMode::false_color || d.mode == DisplayMode::color) {
    const float speed = max(1e-5f, 0.005f * (d.range.y - d.range.x));
    if (ImGui::DragFloatRange2("range", &d.range.x, &d.range.y, speed, 0, 0, "%.4g")) inspector.automatic = false;
  }
  if (d.mode == DisplayMode::false_color) draw_palette(d.range);
}

}  // namespace

void draw_buffers_panel(State& state) {
  draw_choice(state);
  heading("Display");
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.62f);
  if (!state.buffer.empty()) draw_display(state);
  ImGui::Checkbox("Loupe", &state.inspector.loupe);
  tooltip("Magnifies the pixels under the mouse [L]");
  ImGui::SameLine();
  ImGui::SliderInt("zoom", &state.inspector.loupe_zoom, 2, 32);
  ImGui::Checkbox("Sharp pixels", &state.sharp_pixels);
  tooltip("Scales the image without smoothing");
  heading("Resolution");
  bool changed = ImGui::Checkbox("Hold the frame rate", &state.resolution_policy.hold_rate);
  tooltip(fmt::format("Scales the resolution, never below {}x{}", kMinWidth, kMinHeight));
  ImGui::BeginDisabled(!state.resolution_policy.hold_rate);
  changed |= ImGui::SliderFloat("target", &state.resolution_policy.target_hz, 1, 60, "%.0f frames/s",
                                ImGuiSliderFlags_AlwaysClamp);
  changed |= ImGui::Checkbox("Upscale first", &state.resolution_policy.upscale);
  tooltip("Before lowering the resolution, traces paths in a quarter of the pixels per frame (svgf, asvgf, bmfr)");
  changed |= ImGui::Checkbox("Full size at rest", &state.resolution_policy.full_at_rest);
  tooltip("Full resolution once nothing changes; every change of size discards histories");
  ImGui::EndDisabled();
  ImGui::PopItemWidth();
  if (changed) state.request_changed = true;
}

}  // namespace relume::viewer
