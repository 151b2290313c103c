#include "combinations/cells.h"

#include <algorithm>
#include <map>
#include <variant>

#include <fmt/format.h>

#include "core/error.h"
#include "render/build_pipeline.h"
#include "settings/setting.h"

namespace relume::support {
namespace {

constexpr std::string_view kBackward = "reproject (backward)";

/// How far a choice may move the mean of the small Cornell box. Each technique's page says where its bias comes from
/// and its own tests hold it closer; here it only must not lose or invent light.
double stated_bias(const std::string& slot, const std::string& value) {
  static const std::map<std::string, double> kBiases = {
      {"cache=psf", 0.02},      {"cache=apsf", 0.02},        {"cache=apg", 0.03},
      {"cache=apsf+apg", 0.03}, {"history=reproject", 0.02}, {"denoise=bmfr", 0.03},
      {"denoise=svgf", 0.03},   {"denoise=oidn", 0.05},      {"history=reproject (backward)", 0.02}};
  const auto found = kBiases.find(slot + "=" + value);
  return found == kBiases.end() ? 0 : found->second;
}

std::string_view symbol(Cell cell) {
  switch (cell) {
    case Cell::unbiased: return "●";
    case Cell::biased: return "◐";
    case Cell::needs_library: return "◌";
    case Cell::refused: break;
  }
  return "–";
}

}  // namespace

const std::vector<Choice>& all_choices() {
  static const std::vector<Choice> choices = [] {
    std::vector<Choice> list;
    RenderSettings settings;
    for (const Setting& slot : describe_slots(settings)) {
      for (const std::string_view name : std::get<ChoiceRef>(slot.value).names) {
        const std::string value(name);
        list.push_back({slot.name, value, stated_bias(slot.name, value)});
        if (slot.name == "history" && value == "reproject")
          list.push_back({slot.name, std::string(kBackward), stated_bias(slot.name, std::string(kBackward))});
      }
    }
    return list;
  }();
  return choices;
}

RenderSettings combine(RenderSettings settings, const Choice& a, const Choice& b) {
  const SettingList slots = describe_slots(settings);
  for (const Choice& choice : {a, b}) {
    const bool backward = choice.value == kBackward;
    assign(require_setting(slots, choice.slot, "combination"), backward ? "reproject" : choice.value, choice.slot);
    if (backward) settings.reproject.method = ReprojectionMethod::backward;
  }
  return settings;
}

std::string refusal(const RenderSettings& settings) {
  try {
    check_combination(settings);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

Cell cell_of(const Choice& a, const Choice& b) {
  if (a.value == "oidn" || b.value == "oidn") return Cell::needs_library;
  if (!refusal(combine({}, a, b)).empty()) return Cell::refused;
  return a.bias + b.bias > 0 ? Cell::biased : Cell::unbiased;
}

std::string combination_table() {
  const std::vector<Choice>& choices = all_choices();
  std::string text =
      "# What combines with what\n\n"
      "Every choice of every slot with every choice of every other, all else at its default. Written by the test "
      "`combinations`, which renders each\ncell and compares its mean with a reference; "
      "`RELUME_WRITE=1` in its environment writes this file anew.\n\n"
      "● runs, right in the mean · ◐ runs, with the bias that the technique's page states · ◌ needs a library that "
      "Debian 12 does not have ·\n– refused at start, for the reasons below\n\n|  |";
  for (size_t i = 0; i < choices.size(); ++i) text += fmt::format(" {} |", i + 1);
  text += "\n|---|";
  for (size_t i = 0; i < choices.size(); ++i) text += "---|";
  std::vector<std::string> reasons;
  for (size_t row = 0; row < choices.size(); ++row) {
    text += fmt::format("\n| {} `{}={}` |", row + 1, choices[row].slot, choices[row].value);
    for (size_t column = 0; column < choices.size(); ++column) {
      if (choices[row].slot == choices[column].slot) {
        text += "  |";
        continue;
      }
      const Cell cell = cell_of(choices[row], choices[column]);
      text += fmt::format(" {} |", symbol(cell));
      if (cell != Cell::refused) continue;
      const std::string reason = refusal(combine({}, choices[row], choices[column]));
      if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) reasons.push_back(reason);
    }
  }
  text += "\n\n## Refused\n\n";
  for (const std::string& reason : reasons) text += fmt::format("- {}\n", reason);
  return text;
}

}  // namespace relume::support
