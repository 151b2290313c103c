#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <imgui/imgui.h>

#include "cli/console.h"
#include "cli/reports.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"

namespace relume::viewer {
namespace {

/// Colours by order of first appearance; neighbours also differ for colour-blind users.
ImU32 pass_color(size_t index) {
  constexpr std::array kColors = {IM_COL32(86, 148, 214, 255),  IM_COL32(242, 166, 90, 255),
                                  IM_COL32(92, 184, 142, 255),  IM_COL32(214, 110, 138, 255),
                                  IM_COL32(166, 140, 220, 255), IM_COL32(212, 200, 98, 255),
                                  IM_COL32(96, 196, 206, 255),  IM_COL32(190, 140, 106, 255)};
  return kColors[index % kColors.size()];
}

/// Top of the graph's scale: a round number above nine tenths of the frames, and above the target.
double top_s(const FrameTimes& times, double target_s) {
  std::vector<double> all{0};
  for (const FrameTimes::Entry& entry : times.entries) all.push_back(entry.seconds);
  const auto high_frame = all.begin() + static_cast<std::ptrdiff_t>(all.size() * 9 / 10);
  std::nth_element(all.begin(), high_frame, all.end());
  const double high = std::max(*high_frame, 1.2 * target_s) * 1.1;
  for (double step = 0.001; step < 1000; step *= 10) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (step * factor >= high) return step * factor;
    }
  }
  return high;
}

void draw_bars(const FrameTimes& times, const ImVec2& at, const ImVec2& size, double top) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float bar = size.x / static_cast<float>(FrameTimes::kMost);
  float x = at.x + size.x - bar * static_cast<float>(times.entries.size());
  for (const FrameTimes::Entry& entry : times.entries) {
    float y = at.y + size.y;
    for (size_t i = 0; i < times.names.size(); ++i) {
      for (const PassTime& pass : entry.passes) {
        if (pass.name != times.names[i]) continue;
        const float height = std::min(static_cast<float>(pass.seconds / top) * size.y, y - at.y);
        list.AddRectFilled({x, y - height}, {x + std::max(bar - 0.5f, 1.0f), y}, pass_color(i));
        y -= height;
      }
    }
    x += bar;
  }
}

void draw_graph(const FrameTimes& times, const ImVec2& size, double target_s) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::Dummy(size);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + size.x, at.y + size.y}, IM_COL32(20, 21, 25, 255), 4);
  const double top = top_s(times, target_s);
  draw_bars(times, at, size, top);
  const float y = at.y + size.y * (1 - static_cast<float>(target_s / top));
  list.AddLine({at.x, y}, {at.x + size.x, y}, IM_COL32(255, 255, 255, 110));
  const auto label = [&](float text_y, double seconds) {
    const std::string text = seconds < 1 ? fmt::format("{:.4g} ms", seconds * 1000) : fmt::format("{:.4g} s", seconds);
    list.AddText({at.x + 6, text_y}, kTextDim, text.c_str());
  };
  const float line = ImGui::GetFontSize() + 2;
  label(at.y + 1, top);
  // Below its line, or above it if there is no room; omitted if it would cover the other.
  const float own = y + line > at.y + size.y ? y - line : y + 1;
  if (own > at.y + line) label(own, target_s);
}

void draw_legend(const FrameTimes& times) {
  for (size_t i = 0; i < times.names.size(); ++i) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float side = ImGui::GetFontSize() * 0.7f;
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + 3}, {at.x + side, at.y + 3 + side}, pass_color(i), 2);
    ImGui::Dummy({side, side});
    ImGui::SameLine();
    ImGui::Text("%s", times.names[i].c_str());
    ImGui::SameLine(ImGui::GetFontSize() * 8.5f);
    ImGui::Text("%7.2f ms", times.mean_s(times.names[i]) * 1000);
  }
}

void draw_numbers(const State& state, const ViewerFrame& frame) {
  const auto row = [](const char* name, const std::string& value) {
    ImGui::PushStyleColor(ImGuiCol_Text, kTextDim);
    ImGui::TextUnformatted(name);
    ImGui::PopStyleColor();
    ImGui::SameLine(ImGui::GetFontSize() * 5.5f);
    ImGui::TextUnformatted(value.c_str());
  };
  row("frames", fmt::format("{:.1f} per second", state.frames_per_s));
  row("rays", fmt::format("{:.2f} M per second", frame.rays_per_s * 1e-6));
  row("samples", cli::format_samples(frame.samples) + " per pixel");
  row("interface", fmt::format("{:.0f} Hz", state.interface_hz));
  const Statistics& s = frame.statistics;
  row("memory", cli::format_bytes(s.scene_bytes + s.buffer_bytes + s.technique_bytes));
}

}  // namespace

void draw_timing_panel(State& state, int side) {
  const FrameTimes& times = state.times[static_cast<size_t>(side)];
  const ViewerFrame* frame = state.frames[static_cast<size_t>(side)].get();
  if (!frame) return;
  const ImVec2 room = ImGui::GetContentRegionAvail();
  const float font = ImGui::GetFontSize();
  const float legend = font * 15;
  const bool wide = room.x > font * 46;  // else the graph needs the space
  const float numbers = wide ? font * 14 : 0;
  const double target_s = 1.0 / static_cast<double>(state.resolution_policy.target_hz);
  draw_graph(times, {std::max(80.0f, room.x - numbers - legend - 24), room.y}, target_s);
  ImGui::SameLine();
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {8, 2});
  ImGui::BeginChild("legend", {legend, room.y});
  draw_legend(times);
  ImGui::EndChild();
  if (wide) {
    ImGui::SameLine();
    ImGui::BeginChild("numbers", {numbers, room.y});
    draw_numbers(state, *frame);
    ImGui::EndChild();
  }
  ImGui::PopStyleVar();
}

}  // namespace relume::viewer
