#include "viewer/panels/widgets.h"

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <glm/trigonometric.hpp>

#include "viewer/panels/theme.h"

namespace relume::viewer {

void tooltip(const std::string& text) {
  if (text.empty() || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(ImGui::GetFontSize() * 24);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void heading(const char* text) {
  ImGui::Spacing();
  ImGui::PushStyleColor(ImGuiCol_Text, kAccent);
  ImGui::TextUnformatted(text);
  ImGui::PopStyleColor();
  ImGui::Separator();
}

bool radiant_widget(const char* label, Rgb& value, const char* unit) {
  const float largest = max_component(value);
  float strength = largest;
  Rgb color = largest > 0 ? value / largest : Rgb(1);
  ImGui::PushID(label);
  bool changed = ImGui::ColorEdit3(label, &color.x, ImGuiColorEditFlags_Float | ImGuiColorEditFlags_NoInputs);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  const std::string format = fmt::format("%.3f {}", unit);
  changed |= ImGui::DragFloat("##strength", &strength, max(0.005f, strength * 0.01f), 0, 1e9f, format.c_str(),
                              ImGuiSliderFlags_AlwaysClamp);
  ImGui::PopID();
  if (changed) value = color * strength;
  return changed;
}

bool share_widget(const char* label, float& value, const char* help) {
  const bool changed = ImGui::SliderFloat(label, &value, 0, 1, "%.3f", ImGuiSliderFlags_AlwaysClamp);
  tooltip(help);
  return changed;
}

bool angle_widget(const char* label, float& value_rad, float low_deg, float high_deg) {
  float value_deg = glm::degrees(value_rad);
  if (!ImGui::SliderFloat(label, &value_deg, low_deg, high_deg, "%.1f\xc2\xb0", ImGuiSliderFlags_AlwaysClamp))
    return false;
  value_rad = glm::radians(value_deg);
  return true;
}

}  // namespace relume::viewer
