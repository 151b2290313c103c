#include "combinations/cells.h"

#include <algorithm>
#include <map>
#include <variant>

#include <fmt/format.h>

#include "render/build_pipeline.h"
#include "settings/setting.h"
#include "settings/settings_json.h"
#include "support/technique_checks.h"

namespace relume::support {
namespace {

constexpr std::string_view kBackward = "reproject (backward)";

/// Largest bias of a choice on the mean in the test's small box. Each technique's page explains its bias, which its own
/// tests measure more precisely. Here it must not lose or create energy.
double stated_bias(const std::string& slot, const std::string& value) {
  const auto& biases = technique_checks().biases;
  const auto found = biases.find(slot + "=" + value);
  return found == biases.end() ? 0 : found->second;
}

/// Additional bias of a denoiser over a noisy choice.
struct PairBias {
  std::string_view denoiser;
  std::string_view noisy;
  double bias;
};
constexpr PairBias kPairBiases[] = {
    {"bmfr", "light", 0.02},  // fits are clamped to black, which adds energy with few bright samples
    // Neighbours reject rare, bright samples.
    {"svgf", "mcpg", 0.03},
    {"asvgf", "mcpg", 0.03},
};

double pair_bias(std::string_view denoiser, std::string_view noisy) {
  for (const PairBias& pair : kPairBiases) {
    if (pair.denoiser == denoiser && pair.noisy == noisy) return pair.bias;
  }
  return 0;
}

/// A table of every choice against every other.
std::string matrix(const std::function<std::string(size_t row, size_t column)>& cell) {
  const std::vector<Choice>& choices = all_choices();
  std::string text = "|  |";
  for (size_t i = 0; i < choices.size(); ++i) text += fmt::format(" {} |", i + 1);
  text += "\n|---|";
  for (size_t i = 0; i < choices.size(); ++i) text += "---|";
  for (size_t row = 0; row < choices.size(); ++row) {
    text += fmt::format("\n| {} `{}={}` |", row + 1, choices[row].slot, choices[row].value);
    for (size_t column = 0; column < choices.size(); ++column) text += fmt::format(" {} |", cell(row, column));
  }
  return text + "\n";
}

bool needs_library(const Choice& a, const Choice& b) { return a.value == "oidn" || b.value == "oidn"; }

/// `text` broken at blanks into lines of at most 100 bytes, of which all but the first begin with `indent`.
std::string wrapped(std::string text, std::string_view indent = "") {
  constexpr size_t kColumns = 100;
  size_t begin = 0;
  while (text.size() - begin > kColumns) {
    const size_t blank = text.rfind(' ', begin + kColumns);
    text.replace(blank, 1, fmt::format("\n{}", indent));
    begin = blank + 1;
  }
  return text;
}

std::string bias_list() {
  std::string text;
  for (const Choice& choice : all_choices()) {
    if (choice.bias <= 0) continue;
    text += fmt::format("{}`{}={}` {:.0f} %", text.empty() ? "" : ", ", choice.slot, choice.value, 100 * choice.bias);
  }
  text += ". In addition";
  for (const PairBias& pair : kPairBiases)
    text += fmt::format(", `{}` over `{}` {:.0f} %", pair.denoiser, pair.noisy, 100 * pair.bias);
  return text;
}

}  // namespace

double bias_of(const Choice& a, const Choice& b) {
  return a.bias + b.bias + pair_bias(a.value, b.value) + pair_bias(b.value, a.value);
}

double bias_of(RenderSettings settings) {
  double bias = 0;
  // Slots, and other settings with a stated bias of their own.
  for (const Setting& setting : describe(settings)) bias += stated_bias(setting.name, to_string(setting));
  const SettingList slots = describe_slots(settings);
  const std::string denoiser = to_string(require_setting(slots, "denoise", ""));
  for (const std::string_view slot : {"estimator", "guide"})
    bias += pair_bias(denoiser, to_string(require_setting(slots, slot, "")));
  return bias;
}

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

std::string name_of(const std::pair<Choice, Choice>& pair) {
  return fmt::format("{}={} with {}={}", pair.first.slot, pair.first.value, pair.second.slot, pair.second.value);
}

std::vector<Cell> distinct_cells(const RenderSettings& base) {
  const std::vector<Choice>& choices = all_choices();
  std::vector<Cell> cells;
  std::map<std::string, size_t> known;
  for (size_t i = 0; i < choices.size(); ++i) {
    for (size_t k = i + 1; k < choices.size(); ++k) {
      if (choices[k].slot == choices[i].slot) continue;
      Cell cell{combine(base, choices[i], choices[k]), {}, bias_of(choices[i], choices[k])};
      if (!refusal(cell.settings).empty()) continue;
      const auto [found, is_new] = known.try_emplace(settings_to_json(describe(cell.settings)), cells.size());
      if (is_new) cells.push_back(cell);
      cells[found->second].pairs.emplace_back(choices[i], choices[k]);
      cells[found->second].bias = std::min(cells[found->second].bias, cell.bias);
    }
  }
  return cells;
}

std::string combination_table(const std::function<bool(const Choice& a, const Choice& b)>& holds) {
  const std::vector<Choice>& choices = all_choices();
  std::vector<std::string> reasons;
  const auto symbol = [&](const Choice& a, const Choice& b) {
    if (needs_library(a, b)) return "◌";
    if (const std::string reason = refusal(combine({}, a, b)); !reason.empty()) {
      if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end()) reasons.push_back(reason);
      return "–";
    }
    if (!holds(a, b)) return "✗";
    return bias_of(a, b) > 0 ? "◐" : "●";
  };
  std::string text =
      "# Combinations of techniques\n\nEach cell is one pair of choices of two slots, with all other settings at their "
      "defaults.\n`RELUME_WRITE=1 build/release/tests/combinations_tests --gtest_filter='CombinationTable.*'` "
      "renders\nthe cells in an open Cornell box with three lamps under a sky, while the camera moves once. "
      "It\ncompares their means with that of path tracing, and writes this page.\n\n● unbiased · ◐ biased within the "
      "stated bound · ✗ wrong · ◌ needs a library that Debian 12 does not\nhave · – reports an error for the "
      "reasons below\n\n" +
      wrapped("Bounds of the bias (two biased choices: the sum): " + bias_list() + ".") +
      "\n\nA cell passes if the errors of luminance, red, green and blue are each below the bound plus 4.5\nstandard "
      "errors. The standard error is at most 0.5 % of the luminance, or 0.25 % in the slow test.\n[Measured "
      "errors](#measured) are at the end.\n\nThe slow test `SlowTriples` compares 500 random combinations of three or "
      "more choices in the same\nway. There, Student's t and Šidák's correction over all comparisons take the place of "
      "the 4.5\nstandard errors. It also compares their bits with five threads and after a resume.\n\n";
  std::vector<std::string> symbols(choices.size() * choices.size());  // the table is symmetric
  text += matrix([&](size_t row, size_t column) {
    std::string& cell = symbols[row * choices.size() + column];
    if (column < row) {
      cell = symbols[column * choices.size() + row];
    } else if (choices[row].slot != choices[column].slot) {
      cell = symbol(choices[row], choices[column]);
    }
    return cell;
  });
  text += "\n## Refused\n\n";
  text += wrapped(
      "\"Not implemented\" marks work that was not done. Each other sentence states what forbids its combination. "
      "The list has pairs of choices with all other settings at their defaults. The pages of the techniques state "
      "further refusals.");
  text += "\n\n";
  for (const std::string& reason : reasons) text += wrapped("- " + reason, "  ") + "\n";
  return text;
}

std::string deviation_table(const std::function<Deviation(const Choice& a, const Choice& b)>& measured) {
  const std::vector<Choice>& choices = all_choices();
  std::string text = kDeviationsTitle;
  text +=
      "\nThe error of the mean luminance in percent, with its standard error in brackets. Seeds are fixed,\nbut "
      "compilers and vector units round differently, so the last digits may differ on another machine.\n\n";
  return text + matrix([&](size_t row, size_t column) -> std::string {
           const Choice& a = choices[row];
           const Choice& b = choices[column];
           if (column < row || a.slot == b.slot || needs_library(a, b) || !refusal(combine({}, a, b)).empty())
             return "";
           const Deviation deviation = measured(a, b);
           return fmt::format("{:+.1f} ({:.1f})", 100 * deviation.value, 100 * deviation.error);
         });
}

}  // namespace relume::support
