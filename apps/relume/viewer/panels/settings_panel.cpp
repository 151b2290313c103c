#include "viewer/panels/settings_panel.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <imgui/imgui.h>
#include <imgui/imgui_stdlib.h>

#include "relume/error.h"
#include "render/presets.h"
#include "viewer/model/setting_rules.h"
#include "viewer/model/setting_search.h"
#include "viewer/panels/theme.h"
#include "viewer/panels/widgets.h"

namespace relume::viewer {
namespace {

constexpr double kUnbounded = 1e29;  // beyond it, SettingTraits counts as unbounded

bool bounded(const SettingTraits& t) { return t.min > -kUnbounded && t.max < kUnbounded; }

bool int_widget(int* value, const SettingTraits& t) {
  const auto low = static_cast<int>(std::max(t.min, -2147483648.0));
  const auto high = static_cast<int>(std::min(t.max, 2147483647.0));
  if (bounded(t) && t.max - t.min <= 64)
    return ImGui::SliderInt("##v", value, low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
  const float speed = std::max(0.2f, static_cast<float>(std::abs(*value)) * 0.01f);
  return ImGui::DragInt("##v", value, speed, low, high, "%d", ImGuiSliderFlags_AlwaysClamp);
}

bool float_widget(float* value, const SettingTraits& t) {
  const auto low = static_cast<float>(std::max(t.min, -3e38));
  const auto high = static_cast<float>(std::min(t.max, 3e38));
  std::string format = std::fabs(*value) > 0 && std::fabs(*value) < 0.01f ? "%.5f" : "%.3f";
  if (!t.unit.empty()) format += " " + std::string(t.unit == "%" ? "%%" : t.unit);
  if (bounded(t) && t.max - t.min <= 20)
    return ImGui::SliderFloat("##v", value, low, high, format.c_str(), ImGuiSliderFlags_AlwaysClamp);
  const float speed = std::max(0.002f, std::fabs(*value) * 0.01f);
  return ImGui::DragFloat("##v", value, speed, low, high, format.c_str(), ImGuiSliderFlags_AlwaysClamp);
}

bool choice_widget(const AllSettings& settings, const Setting& setting, const ChoiceRef& choice) {
  bool changed = false;
  const std::string current(choice.names.at(static_cast<size_t>(*choice.value)));
  if (!ImGui::BeginCombo("##v", current.c_str())) return false;
  for (size_t i = 0; i < choice.names.size(); ++i) {
    const std::string name(choice.names[i]);
    const std::string reason = refusal(settings, setting.name, name);
    ImGui::BeginDisabled(!reason.empty());
    if (ImGui::Selectable(name.c_str(), *choice.value == static_cast<int>(i))) {
      *choice.value = static_cast<int>(i);
      changed = true;
    }
    ImGui::EndDisabled();
    if (!reason.empty()) tooltip(reason);
  }
  ImGui::EndCombo();
  return changed;
}

bool text_widget(std::string* value) {
  // Names of files and cameras are valid only when complete, so an edit in progress is kept here. ImGui does not return
  // it when a widget drawn earlier takes the keyboard focus.
  static ImGuiID edited = 0;
  static std::string text;
  const ImGuiID id = ImGui::GetID("##v");
  std::string shown = edited == id ? text : *value;
  ImGui::InputText("##v", &shown);
  if (ImGui::IsItemActive()) {
    edited = id;
    text = shown;
    return false;
  }
  if (edited != id) return false;
  edited = 0;
  if (!ImGui::IsItemDeactivatedAfterEdit()) return false;
  *value = shown;
  return true;
}

/// Context of the rows of settings.
struct RowContext {
  const AllSettings& settings;
  const SettingList& standard;  ///< target of "Reset"
  float exposure;               ///< current automatic exposure
  bool ocio;                    ///< whether an OpenColorIO view replaces the tone map
};

/// Reason why the setting has no effect, as a sentence; empty if it has one.
std::string why_inactive(const RowContext& context, const Setting& setting) {
  if (context.ocio && setting.name == "tone-map") return "Replaced by the view of --ocio.";
  const std::string choice = takes_effect_with(context.settings, setting.name);
  return choice.empty() ? choice : "Takes effect with " + choice + ".";
}

/// A checkbox for the automatic value, and the number beside it. `present`: the current automatic value.
bool optional_number_widget(const OptionalNumberRef& number, const SettingTraits& traits, float present) {
  bool automatic = !number.value->has_value();
  const bool changed = ImGui::Checkbox(std::string(number.word).c_str(), &automatic);
  set_automatic(number, automatic, present);
  if (automatic) return changed;
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1);
  return float_widget(&**number.value, traits) || changed;
}

/// The widget for the setting's type. Returns whether the value changed.
bool value_widget(const RowContext& context, const Setting& setting) {
  if (const auto* flag = std::get_if<bool*>(&setting.value)) return ImGui::Checkbox("##v", *flag);
  if (const auto* number = std::get_if<int*>(&setting.value)) return int_widget(*number, setting.traits);
  if (const auto* number = std::get_if<float*>(&setting.value)) return float_widget(*number, setting.traits);
  if (const auto* text = std::get_if<std::string*>(&setting.value)) return text_widget(*text);
  if (const auto* number = std::get_if<OptionalNumberRef>(&setting.value))
    return optional_number_widget(*number, setting.traits, setting.name == "exposure" ? context.exposure : 0.0f);
  return choice_widget(context.settings, setting, std::get<ChoiceRef>(setting.value));
}

std::string help_of(const Setting& setting, const Setting& standard, const std::string& inactive) {
  std::string text = fmt::format("{}\n\n--{}: {}; default {}", setting.help, setting.name, describe_type(setting),
                                 to_string(standard).empty() ? "empty" : to_string(standard));
  if (setting.traits.resets_history) text += "\nA change discards the accumulated frames.";
  if (setting.traits.biases) text += "\nSome values bias the image.";
  if (!inactive.empty()) text += "\n" + inactive;
  return text;
}

/// A row: name, widget, and reset on a right click.
bool setting_row(const RowContext& context, const Setting& setting) {
  const Setting& standard = *find_setting(context.standard, setting.name);
  const std::string inactive = why_inactive(context, setting);
  const bool differs = load(setting) != load(standard);
  ImGui::PushID(setting.name.c_str());
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::AlignTextToFramePadding();
  const ImU32 color = !inactive.empty() ? kTextDim : differs ? kAccent : ImGui::GetColorU32(ImGuiCol_Text);
  ImGui::PushStyleColor(ImGuiCol_Text, color);
  ImGui::TextUnformatted(setting.name.c_str());
  ImGui::PopStyleColor();
  const auto explain = [&] {
    if (ImGui::IsItemHovered()) tooltip(help_of(setting, standard, inactive));
  };
  explain();
  bool changed = false;
  if (ImGui::BeginPopupContextItem("reset")) {
    const std::string value = to_string(standard);
    if (ImGui::MenuItem(("Reset to " + (value.empty() ? "empty" : value)).c_str(), nullptr, false, differs)) {
      store(setting, load(standard));
      changed = true;
    }
    ImGui::EndPopup();
  }
  ImGui::TableNextColumn();
  ImGui::SetNextItemWidth(-1);
  changed |= value_widget(context, setting);
  if (!ImGui::IsItemActive()) explain();
  ImGui::PopID();
  return changed;
}

void draw_presets(State& state) {
  ImGui::SetNextItemWidth(-1);
  if (!ImGui::BeginCombo("##preset", "Apply a preset...")) return;
  for (const Preset& preset : presets()) {
    if (ImGui::Selectable(std::string(preset.name).c_str())) {
      try {
        apply_preset(state, state.edited_side, std::string(preset.name));
        state.notify(fmt::format("{} uses the preset {}", state.edited_side == 0 ? "A" : "B", preset.name));
      } catch (const Error& error) {
        state.notify(error.what(), true);
      }
    }
    tooltip(std::string(preset.summary));
  }
  ImGui::EndCombo();
}

void draw_sides(State& state) {
  bool split = state.split;
  if (ImGui::Checkbox("Compare A and B", &split)) set_split(state, split);
  tooltip("Renders two sets of settings in alternation; drag the dividing line in the image [B]");
  if (!state.split) return;
  ImGui::SameLine();
  ImGui::RadioButton("edit A", &state.edited_side, 0);
  ImGui::SameLine();
  ImGui::RadioButton("edit B", &state.edited_side, 1);
  if (ImGui::Button("Copy A to B")) {
    state.settings[1] = state.settings[0];
    state.touch();
  }
  ImGui::SameLine();
  if (ImGui::Button("Swap")) {
    std::swap(state.settings[0], state.settings[1]);
    state.touch();
  }
}

/// Returns whether a value changed.
bool draw_rows(State& state, const RowContext& context, const char* id, const std::vector<const Setting*>& rows) {
  if (rows.empty() || !ImGui::BeginTable(id, 2)) return false;
  ImGui::TableSetupColumn("name", ImGuiTableColumnFlags_WidthStretch, 0.5f);
  ImGui::TableSetupColumn("value", ImGuiTableColumnFlags_WidthStretch, 0.5f);
  bool changed = false;
  for (const Setting* setting : rows) {
    if (!setting_row(context, *setting)) continue;
    changed = true;
    if (setting->name == "width" || setting->name == "height") state.follow_window = false;
  }
  ImGui::EndTable();
  return changed;
}

/// The settings of a group that match the query, below its title.
bool draw_group(State& state, const SettingGroup& group, const RowContext& context) {
  std::vector<const Setting*> rows;
  for (const Setting& setting : group.settings) {
    if (matches(setting, state.setting_query)) rows.push_back(&setting);
  }
  if (rows.empty()) return false;
  const std::string title(group.title);
  const bool rarely_used = group.role == SettingGroupRole::stopping && state.setting_query.empty();
  if (!ImGui::CollapsingHeader(title.c_str(), rarely_used ? 0 : ImGuiTreeNodeFlags_DefaultOpen)) return false;
  tooltip(std::string(group.summary));
  return draw_rows(state, context, title.c_str(), rows);
}

bool draw_all(State& state, std::vector<SettingGroup>& groups, const RowContext& context) {
  std::stable_partition(groups.begin(), groups.end(),
                        [](const SettingGroup& group) { return group.role == SettingGroupRole::slots; });
  bool changed = false;
  for (const SettingGroup& group : groups) changed |= draw_group(state, group, context);
  return changed;
}

bool draw_essentials(State& state, const SettingList& list, const RowContext& context) {
  std::vector<const Setting*> rows;
  for (const std::string_view name : kEssentialSettings) rows.push_back(find_setting(list, name));
  const bool changed = draw_rows(state, context, "essential", rows);
  ImGui::Checkbox("Size follows the window", &state.follow_window);
  return changed;
}

void draw_search(State& state, size_t count) {
  ImGui::SetNextItemWidth(-1);
  const std::string hint = fmt::format("Search {} settings by name and help", count);
  ImGui::InputTextWithHint("##search", hint.c_str(), &state.setting_query);
}

}  // namespace

void draw_settings_panel(State& state) {
  draw_sides(state);
  draw_presets(state);
  AllSettings wanted = state.settings[static_cast<size_t>(state.edited_side)];
  const SettingList standard = describe(state.defaults);
  draw_search(state, standard.size());
  const RowContext context{wanted, standard, state.automatic_exposure[static_cast<size_t>(state.edited_side)],
                           state.ocio.view() != nullptr};
  ImGui::BeginChild("settings");
  std::vector<SettingGroup> groups = setting_groups(wanted);
  bool changed = false;
  if (!state.setting_query.empty()) {
    changed = draw_all(state, groups, context);
  } else {
    const SettingList list = describe(wanted);
    changed = draw_essentials(state, list, context);
    if (ImGui::CollapsingHeader("All settings")) changed |= draw_all(state, groups, context);
  }
  ImGui::EndChild();
  if (!changed) return;
  try {
    take_settings(state, state.edited_side, wanted);
  } catch (const Error& error) {
    state.notify(error.what(), true);
  }
}

}  // namespace relume::viewer
