#include "serve/documents.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "render/presets.h"
#include "render/settings.h"
#include "viewer/model/preparation_lines.h"
#include "viewer/model/setting_rules.h"
#include "viewer/model/setting_search.h"

namespace relume::serve {
namespace {

using nlohmann::json;
using viewer::State;

constexpr double kUnbounded = 1e29;  // beyond it, SettingTraits counts as unbounded
constexpr size_t kMostFrameTimes = 120;

/// Text of a message. Names in scene files may be no UTF-8.
std::string text_of(const json& message) { return message.dump(-1, ' ', false, json::error_handler_t::replace); }

std::string_view type_of(const Setting& setting) {
  constexpr std::array<std::string_view, 6> kTypes = {"flag", "integer", "number", "text", "choice", "optional"};
  return kTypes[setting.value.index()];
}

json declaration_of(const Setting& setting) {
  json result = {{"name", setting.name},           {"type", type_of(setting)},
                 {"help", setting.help},           {"about", describe_type(setting)},
                 {"default", to_string(setting)},  {"resets", setting.traits.resets_history},
                 {"biases", setting.traits.biases}};
  if (!setting.traits.unit.empty()) result["unit"] = setting.traits.unit;
  if (setting.traits.min > -kUnbounded) result["min"] = setting.traits.min;
  if (setting.traits.max < kUnbounded) result["max"] = setting.traits.max;
  if (const auto* choice = std::get_if<ChoiceRef>(&setting.value)) result["choices"] = choice->names;
  if (const auto* number = std::get_if<OptionalNumberRef>(&setting.value)) result["word"] = number->word;
  return result;
}

std::string_view role_of(SettingGroupRole role) {
  constexpr std::array<std::string_view, 4> kRoles = {"ordinary", "image", "stopping", "slots"};
  return kRoles[static_cast<size_t>(role)];
}

json group_of(const SettingGroup& group) {
  json settings = json::array();
  for (const Setting& setting : group.settings) settings.push_back(declaration_of(setting));
  return {{"title", group.title}, {"summary", group.summary}, {"role", role_of(group.role)}, {"settings", settings}};
}

json values_of(AllSettings settings) {
  json values = json::object();
  for (const Setting& setting : describe(settings)) values[setting.name] = to_string(setting);
  return values;
}

/// Reasons by slot and choice.
json refusals_of(const AllSettings& settings) {
  json refusals = json::object();
  AllSettings copy = settings;
  for (const Setting& slot : describe_slots(copy.render)) {
    const auto* choice = std::get_if<ChoiceRef>(&slot.value);
    if (choice == nullptr) continue;
    for (const std::string_view name : choice->names) {
      const std::string reason = viewer::refusal(settings, slot.name, name);
      if (!reason.empty()) refusals[slot.name][std::string(name)] = reason;
    }
  }
  return refusals;
}

/// By setting: what it takes effect with.
json inactive_of(const State& state, size_t side) {
  json inactive = json::object();
  AllSettings copy = state.settings[side];
  for (const Setting& setting : describe(copy)) {
    const std::string choice = viewer::takes_effect_with(state.settings[side], setting.name);
    if (!choice.empty()) inactive[setting.name] = "takes effect with " + choice;
  }
  if (state.ocio.view()) inactive["tone-map"] = "replaced by the view of --ocio";
  return inactive;
}

json buffers_of(const State& state) {
  json buffers = json::array();
  if (!state.frame()) return buffers;
  for (const AovLayer& buffer : state.frame()->buffers)
    buffers.push_back({{"name", buffer.name}, {"help", buffer.help}});
  return buffers;
}

json sides_of(const State& state) { return json::array({values_of(state.settings[0]), values_of(state.settings[1])}); }

json times_of(const viewer::FrameTimes& times) {
  json passes = json::array();
  for (const std::string& name : times.names) passes.push_back({{"name", name}, {"ms", 1000 * times.mean_s(name)}});
  json frames = json::array();
  const size_t first = times.entries.size() - std::min(times.entries.size(), kMostFrameTimes);
  for (size_t i = first; i < times.entries.size(); ++i) frames.push_back(1000 * times.entries[i].seconds);
  return {{"passes", passes}, {"frames_ms", frames}};
}

void add_frame(const viewer::ViewerFrame& frame, json& status) {
  const Statistics& s = frame.statistics;
  status["width"] = frame.width;
  status["height"] = frame.height;
  status["full_width"] = frame.full_width;
  status["samples"] = frame.samples;
  status["rays_per_s"] = frame.rays_per_s;
  status["done"] = frame.reached_goal;
  status["bytes"] = s.scene_bytes + s.buffer_bytes + s.technique_bytes;
  status["shown_buffer"] = frame.buffer;
  status["range"] = {frame.value_range.x, frame.value_range.y};
}

}  // namespace

std::string declarations_text(const State& state) {
  AllSettings defaults = state.defaults;
  json groups = json::array();
  std::vector<SettingGroup> all = setting_groups(defaults);
  std::stable_partition(all.begin(), all.end(),
                        [](const SettingGroup& group) { return group.role == SettingGroupRole::slots; });
  for (const SettingGroup& group : all) groups.push_back(group_of(group));
  json named = json::array();
  for (const Preset& preset : presets()) named.push_back({{"name", preset.name}, {"summary", preset.summary}});
  return text_of(
      {{"kind", "declarations"}, {"groups", groups}, {"essential", viewer::kEssentialSettings}, {"presets", named}});
}

std::string values_key(const State& state) { return text_of({sides_of(state), buffers_of(state), state.split}); }

std::string values_text(const State& state) {
  json refused = json::array();
  json inactive = json::array();
  for (size_t side = 0; side < viewer::kSides; ++side) {
    refused.push_back(refusals_of(state.settings[side]));
    inactive.push_back(inactive_of(state, side));
  }
  return text_of({{"kind", "values"},
                  {"sides", sides_of(state)},
                  {"refused", refused},
                  {"inactive", inactive},
                  {"buffers", buffers_of(state)}});
}

std::string status_text(const State& state) {
  json status = {{"kind", "status"},
                 {"frames_per_s", state.frames_per_s},
                 {"target_hz", state.resolution_policy.target_hz},
                 {"buffer", state.buffer},
                 {"split", state.split},
                 {"split_at", state.split_at},
                 {"paused", state.paused},
                 {"animating", state.animating},
                 {"orbits", state.navigation.mode == viewer::CameraMode::orbit},
                 {"speed", state.fly.speed},
                 {"times", json::array()},
                 {"messages", json::array()},
                 {"bookmarks", json::array()}};
  for (int side = 0; side < state.sides(); ++side)
    status["times"].push_back(times_of(state.times[static_cast<size_t>(side)]));
  for (const viewer::Toast& toast : state.toasts)
    status["messages"].push_back({{"text", toast.text}, {"problem", toast.problem}});
  for (const viewer::Bookmark& bookmark : state.bookmarks) status["bookmarks"].push_back(bookmark.name);
  if (state.document) {
    status["scene"] = state.document->name();
    status["preparing"] = viewer::preparation_lines(state);
  }
  if (state.has_camera()) {
    const viewer::Viewpoint view = viewer::current_view(state);
    const Vec3 forward = view.rotation * Vec3(0, 0, -1);
    status["eye"] = {view.eye.x, view.eye.y, view.eye.z};
    status["forward"] = {forward.x, forward.y, forward.z};
  }
  if (state.frame()) add_frame(*state.frame(), status);
  return text_of(status);
}

}  // namespace relume::serve
