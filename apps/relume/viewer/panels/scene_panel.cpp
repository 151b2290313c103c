#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "relume/builtin_scenes.h"
#include "scene_io/scene_format.h"
#include "viewer/model/actions.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"

namespace relume::viewer {
namespace {

constexpr int kRows = 7;  // visible rows of a list

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

std::string label_of(const std::string& name, const char* kind, size_t index) {
  return name.empty() ? fmt::format("{} {}", kind, index) : name;
}

/// A list, with a filter above it if it is long. `label(i)` is empty for excluded items.
template <typename Label>
void draw_list(State& state, const char* title, size_t count, Selected kind, std::string& filter, const Label& label) {
  const std::string wanted = lower(filter);
  std::vector<std::pair<size_t, std::string>> rows;
  for (size_t i = 0; i < count; ++i) {
    std::string text = label(i);
    if (!text.empty() && lower(text).find(wanted) != std::string::npos) rows.emplace_back(i, std::move(text));
  }
  if (rows.empty() && filter.empty()) return;
  const std::string header = fmt::format("{} ({})###{}", title, rows.size(), title);
  if (!ImGui::CollapsingHeader(header.c_str(), ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::PushID(title);
  if (rows.size() > kRows || !filter.empty()) {
    ImGui::SetNextItemWidth(-1);
    ImGui::InputTextWithHint("##filter", "filter", &filter);
  }
  const float height = ImGui::GetTextLineHeightWithSpacing();
  ImGui::BeginChild("rows", {0, height * static_cast<float>(std::clamp<size_t>(rows.size(), 1, kRows)) + 4});
  ImGuiListClipper clipper;
  clipper.Begin(static_cast<int>(rows.size()));
  while (clipper.Step()) {
    for (int row = clipper.DisplayStart; row < clipper.DisplayEnd; ++row) {
      const auto& [index, text] = rows[static_cast<size_t>(row)];
      ImGui::PushID(row);
      const bool chosen = state.selection.kind == kind && state.selection.index == static_cast<Index>(index);
      if (ImGui::Selectable(text.c_str(), chosen)) select(state, {kind, static_cast<Index>(index)});
      ImGui::PopID();
    }
  }
  ImGui::EndChild();
  ImGui::PopID();
}

void draw_open(State& state) {
  ImGui::SetNextItemWidth(-1);
  const std::string shown = state.loading.valid() ? "loading " + state.loading_name + " ..." : state.document->name();
  if (ImGui::BeginCombo("##open", shown.c_str())) {
    for (const BuiltinSceneInfo& scene : list_builtin_scenes()) {
      if (ImGui::Selectable(scene.name.c_str())) open_scene(state, scene.name);
      tooltip(scene.summary);
    }
    ImGui::EndCombo();
  }
  tooltip("Built-in scenes. For others, drop a file on the window: " + scene_format_names() + ".");
}

/// Animation choice for files with several.
void draw_clips(State& state) {
  const std::vector<std::string>& clips = state.document->outline().clips;
  if (clips.size() < 2) return;
  const std::string& chosen = state.settings[0].render.animation;
  const auto choose = [&](const std::string& choice) { change_setting(state, 0, "animation", choice); };
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##clip", (chosen.empty() ? clips.front() : chosen).c_str())) return;
  for (size_t i = 0; i < clips.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(clips[i].c_str(), clips[i] == chosen)) choose(clips[i]);
    ImGui::PopID();
  }
  if (ImGui::Selectable("all")) choose("all");
  ImGui::EndCombo();
}

/// Material variant choice.
void draw_variants(State& state) {
  const std::vector<std::string>& variants = state.document->outline().variants;
  if (variants.empty()) return;
  heading("Variant");
  const std::string& chosen = state.settings[0].scene.variant;
  const auto choose = [&](const std::string& choice) { change_setting(state, 0, "variant", choice); };
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##variant", chosen.empty() ? "default" : chosen.c_str())) return;
  if (ImGui::Selectable("default", chosen.empty())) choose("");
  for (size_t i = 0; i < variants.size(); ++i) {
    ImGui::PushID(static_cast<int>(i));
    if (ImGui::Selectable(variants[i].c_str(), variants[i] == chosen)) choose(variants[i]);
    ImGui::PopID();
  }
  ImGui::EndCombo();
}

void draw_time(State& state) {
  const float end = state.document->duration_s();
  if (!(end > 0)) return;
  heading("Time");
  draw_clips(state);
  if (ImGui::Button(state.animating ? "Pause" : "Play")) state.animating = !state.animating;
  tooltip("Plays the animation in real time, in a loop [P]");
  ImGui::SameLine();
  float time = state.document->time_s();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##time", &time, 0, end, "%.2f s", ImGuiSliderFlags_AlwaysClamp)) set_scene_time(state, time);
}

}  // namespace

void draw_scene_panel(State& state) {
  if (!state.document) return;
  draw_open(state);
  ImGui::BeginChild("scene");
  draw_selection(state);
  draw_variants(state);
  draw_time(state);
  draw_environment(state);
  heading("Contents");
  static std::string light_filter;  // belongs to the widgets, not to the scene
  static std::string node_filter;
  static std::string material_filter;
  const Scene& scene = state.document->outline();
  draw_list(state, "Lights", scene.lights.size(), Selected::light, light_filter,
            [&](size_t i) { return label_of(scene.lights[i].name, "light", i); });
  draw_list(state, "Objects", scene.nodes.size(), Selected::node, node_filter, [&](size_t i) {
    return scene.nodes[i].meshes.empty() ? std::string() : label_of(scene.nodes[i].name, "object", i);
  });
  draw_list(state, "Materials", scene.materials.size(), Selected::material, material_filter, [&](size_t i) {
    const std::string name = label_of(scene.materials[i].name, "material", i);
    return is_black(scene.materials[i].emission) ? name : name + " (emits)";
  });
  if (state.frame() && !state.frame()->notes.empty()) {
    heading("Notes");
    for (const std::string& note : state.frame()->notes) ImGui::TextWrapped("%s", note.c_str());
  }
  ImGui::EndChild();
}

}  // namespace relume::viewer
