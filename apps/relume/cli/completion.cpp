#include "cli/completion.h"

#include <iterator>

namespace relume::cli {
namespace {

/// Options that commands collect rather than assign may also be files: --env.
Completion completion_of(const Setting& setting) {
  return std::holds_alternative<std::string*>(setting.value) && setting.name == "env" ? Completion::file
                                                                                      : Completion::none;
}

}  // namespace

Offer offer_of(Completion completion, const CompletionNames& names) {
  switch (completion) {
    case Completion::file: return {{}, true};
    case Completion::scene: return {names.scenes, true};
    case Completion::preset: return {names.presets};
    case Completion::command: return {names.commands};
    case Completion::shell: return {{std::begin(kShells), std::end(kShells)}};
    case Completion::experiment: {
      Offer offer{{"list", "run"}};
      offer.words.insert(offer.words.end(), names.experiments.begin(), names.experiments.end());
      return offer;
    }
    case Completion::none: break;
  }
  return {};
}

std::optional<Offer> value_offer(const Option& option, const CompletionNames& names) {
  if (std::holds_alternative<bool*>(option.setting.value)) return std::nullopt;
  if (const auto* choices = std::get_if<ChoiceRef>(&option.setting.value)) {
    return Offer{{choices->names.begin(), choices->names.end()}};
  }
  if (const auto* number = std::get_if<OptionalNumberRef>(&option.setting.value))
    return Offer{{std::string(number->word)}};
  return offer_of(option.completion, names);
}

std::vector<Option> all_options(const Command& command) {
  std::vector<Option> options = command.options;
  for (const Setting& setting : flatten(command.setting_groups))
    options.push_back({setting, "", 0, completion_of(setting)});
  return options;
}

}  // namespace relume::cli
