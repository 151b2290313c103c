#include <cmath>

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>

#include "core/euler.h"
#include "scene/light_parameters.h"
#include "scene/material_parameters.h"
#include "viewer/model/actions.h"
#include "viewer/panels/panels.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"

namespace relume::viewer {
namespace {

/// `shown`: the selected node, whose size sets the step. Bounds of `node` may deform every mesh of a scene.
void draw_transform(State& state, Index node, Index shown) {
  Document& document = *state.document;
  Transform t = document.transform(node);
  const float step = max(0.001f, 0.0005f * document.bounds(shown).diagonal());
  Vec3 rotation_deg = euler_degrees(t.rotation);
  bool changed = ImGui::DragFloat3("position", &t.translation.x, max(step, 0.005f), 0, 0, "%.3f");
  tooltip("Metres, relative to the parent. Ctrl+drag moves it in the image.");
  if (ImGui::DragFloat3("rotation", &rotation_deg.x, 0.5f, 0, 0, "%.1f")) {
    t.rotation = glm::quat(glm::radians(rotation_deg));
    changed = true;
  }
  changed |= ImGui::DragFloat3("scale", &t.scale.x, 0.005f, 0.001f, 1000, "%.3f", ImGuiSliderFlags_AlwaysClamp);
  if (!changed) return;
  document.set_transform(node, t);
  state.touch();
}

void draw_dim(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, kTextDim);
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

/// Widgets for the transform of the node that moves the object, which for a skinned mesh differs from its own.
void draw_object(State& state, Index node) {
  const Mover mover = state.document->mover(node);
  if (mover.node == kNone) return draw_dim(mover.problem);
  draw_transform(state, mover.node, node);
  if (mover.node == node) return;
  draw_dim(fmt::format("Moves '{}', which carries the joints of this skin.", state.document->node_name(mover.node)));
}

void draw_light(State& state, Index index) {
  PunctualLight light = state.document->outline().lights[static_cast<size_t>(index)];
  bool changed = radiant_widget("intensity", light.intensity, type_of(light).unit);
  for (const LightParameter& p : light_parameters()) {
    if (p.type != light.type) continue;
    changed |= angle_widget(p.label, light.*p.member, p.low_shown_deg, p.high_shown_deg);
  }
  for (const LightParameter& p : light_parameters()) light.*p.member = min(light.*p.member, upper_limit(p, light));
  if (changed) {
    state.document->set_light(index, light);
    state.touch();
  }
  const Index node = state.document->node_of_light(index);
  if (node != kNone) draw_transform(state, node, node);
}

bool parameter_widget(const MaterialParameter& p, float& value) {
  const ParameterWidget& w = p.widget;
  if (w.kind == ParameterWidget::Kind::share) return share_widget(w.label, value, w.help);
  if (w.kind != ParameterWidget::Kind::number) return false;
  const bool changed = ImGui::SliderFloat(w.label, &value, p.range.low, w.most, "%.3f", ImGuiSliderFlags_AlwaysClamp);
  tooltip(w.help);
  return changed;
}

bool parameter_widget(const MaterialParameter& p, Rgb& value) {
  const ParameterWidget& w = p.widget;
  if (w.kind == ParameterWidget::Kind::color) return ImGui::ColorEdit3(w.label, &value.x, ImGuiColorEditFlags_Float);
  return w.kind == ParameterWidget::Kind::radiance && radiant_widget(w.label, value, w.help);
}

/// Whether the parameter counts. Mixtures have a share and emission alone; their parts have the others.
bool counts(const MaterialParameter& p, bool is_mixture) {
  const auto is = [&](auto member) { return p.member == MaterialParameter::Member(member); };
  if (is(&Material::mix_share)) return is_mixture;
  return !is_mixture || is(&Material::emission);
}

void draw_material(State& state, Index index) {
  Material m = state.document->outline().materials[static_cast<size_t>(index)];
  const bool is_mixture = m.mix_first != kNone;
  if (is_mixture && ImGui::Button("Go to first part")) state.selection = {Selected::material, m.mix_first};
  if (is_mixture && ImGui::Button("Go to second part")) state.selection = {Selected::material, m.mix_second};
  bool changed = false;
  for_each_parameter(m, [&](const MaterialParameter& p, auto& value) {
    if constexpr (requires { parameter_widget(p, value); })
      changed |= counts(p, is_mixture) && parameter_widget(p, value);
  });
  if (!changed) return;
  state.document->set_material(index, m);
  state.touch();
}

void draw_sun(State& state, SunSky& sky, bool& changed) {
  bool moved = ImGui::SliderFloat("time of day", &state.sun_hour, 0, 24, "%.2f h", ImGuiSliderFlags_AlwaysClamp);
  tooltip("Solar time: moves the sun along its path for the day and latitude below; +Z is south, +X is east");
  moved |= ImGui::SliderInt("day of year", &state.sun_day, 1, 365, "%d", ImGuiSliderFlags_AlwaysClamp);
  moved |= ImGui::SliderFloat("latitude", &state.latitude_deg, -66, 66, "%.0f\xc2\xb0", ImGuiSliderFlags_AlwaysClamp);
  if (moved) {
    move_sun(state, sky);
    changed = true;
  }
  changed |= angle_widget("elevation", sky.sun_elevation_rad, -10, 90);
  changed |= angle_widget("azimuth", sky.sun_azimuth_rad, -180, 180);
  changed |= ImGui::SliderFloat("turbidity", &sky.turbidity, 1.7f, 10, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  tooltip("1.7: clear, 10: hazy");
  changed |= ImGui::SliderFloat("sky", &sky.sky_scale, 0, 4, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  changed |= ImGui::SliderFloat("sun", &sky.sun_scale, 0, 4, "%.2f", ImGuiSliderFlags_AlwaysClamp);
}

}  // namespace

void draw_environment(State& state) {
  heading("Environment");
  Environment e = state.document->outline().environment;
  constexpr const char* kKinds[] = {"none", "constant", "map", "sun and sky", "studio", "automatic"};
  constexpr const char* kHelp = "automatic: the studio if nothing lights the visible surfaces; otherwise none";
  bool changed = false;
  ImGui::SetNextItemWidth(-1);
  if (ImGui::BeginCombo("##kind", kKinds[static_cast<int>(e.kind)])) {
    for (int kind = 0; kind < static_cast<int>(std::size(kKinds)); ++kind) {
      const bool possible = kind != static_cast<int>(EnvironmentKind::map) || state.document->has_environment_map();
      ImGui::BeginDisabled(!possible);
      if (ImGui::Selectable(kKinds[kind])) {
        // The factor of one kind does not apply to another.
        if (e.kind != static_cast<EnvironmentKind>(kind)) e.color = Rgb(1);
        e.kind = static_cast<EnvironmentKind>(kind);
        changed = true;
      }
      ImGui::EndDisabled();
      if (kind == static_cast<int>(EnvironmentKind::automatic)) tooltip(kHelp);
      if (!possible) tooltip("The scene has no map; set one with --env FILE or the setting 'env'.");
    }
    ImGui::EndCombo();
  }
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.62f);
  const bool is_constant = e.kind == EnvironmentKind::constant;
  const bool is_image = e.kind == EnvironmentKind::map || e.kind == EnvironmentKind::studio;
  if (is_constant || is_image) changed |= radiant_widget(is_image ? "factor" : "radiance", e.color, "");
  if (is_image) changed |= angle_widget("rotation", e.rotation_rad, -180, 180);
  if (e.kind == EnvironmentKind::sun_sky) draw_sun(state, e.sun_sky, changed);
  ImGui::PopItemWidth();
  if (!changed) return;
  state.document->set_environment(e);
  state.touch();
}

void draw_selection(State& state) {
  const Selection selection = state.selection;
  if (selection.kind == Selected::nothing) {
    return draw_dim("Select an object in the image or an item in the lists below to edit it.");
  }
  const Scene& scene = state.document->outline();
  const auto at = static_cast<size_t>(selection.index);
  const std::string name = selection.kind == Selected::node    ? scene.nodes[at].name
                           : selection.kind == Selected::light ? scene.lights[at].name
                                                               : scene.materials[at].name;
  constexpr const char* kKinds[] = {"", "Object", "Light", "Material"};
  heading(
      fmt::format("{} {}", kKinds[static_cast<int>(selection.kind)], name.empty() ? std::to_string(at) : name).c_str());
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x * 0.62f);
  if (selection.kind == Selected::node) draw_object(state, selection.index);
  if (selection.kind == Selected::light) draw_light(state, selection.index);
  if (selection.kind == Selected::material) draw_material(state, selection.index);
  ImGui::PopItemWidth();
  if (selection.kind == Selected::node && !scene.nodes[at].meshes.empty()) {
    const Index material = scene.meshes[static_cast<size_t>(scene.nodes[at].meshes.front())].material;
    if (material != kNone && ImGui::Button("Go to material")) state.selection = {Selected::material, material};
  }
}

}  // namespace relume::viewer
