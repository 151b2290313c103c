#include <fmt/format.h>

#include "cli/completion.h"

namespace relume::cli {
namespace {

std::string words(const std::string& list) { return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", list); }

/// Bash that fills COMPREPLY. `mapfile` keeps names with spaces intact.
std::string offer_script(const Offer& offer) {
  const std::string list = fmt::format("{}", fmt::join(offer.words, " "));
  if (!offer.files) return offer.words.empty() ? "COMPREPLY=()" : words(list);
  const std::string files = "compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- \"$cur\")";
  if (offer.words.empty()) return files;
  return fmt::format("{}; COMPREPLY+=($(compgen -W '{}' -- \"$cur\"))", files, list);
}

std::string command_case(const Command& command, const CompletionNames& names) {
  std::string flags = command.essentials.empty() ? "--help" : "--help --help-all";
  std::string text = fmt::format("    {})\n      case $prev in\n", command.name);
  for (const Option& option : all_options(command)) {
    const std::string flag = "--" + option.setting.name;
    flags += " " + flag;
    const std::optional<Offer> offer = value_offer(option, names);
    const std::string letter = option.letter != 0 ? fmt::format("|-{}", option.letter) : "";
    if (offer) {
      text += fmt::format("        {}{}) {}; return ;;\n", flag, letter, offer_script(*offer));
    } else {
      flags += " --no-" + option.setting.name;
    }
  }
  text += fmt::format("      esac\n      if [[ $cur == -* ]]; then {}; return; fi\n", words(flags));
  if (!command.arguments.empty()) {
    text += fmt::format("      {}\n", offer_script(offer_of(command.arguments.front().completion, names)));
  }
  return text + "      ;;\n";
}

}  // namespace

std::string bash_completion(const std::vector<Command>& commands, const CompletionNames& names) {
  std::vector<std::string_view> command_names;
  for (const Command& command : commands) command_names.push_back(command.name);
  std::string text =
      "# Completion of relume for bash; made by `relume completion bash`.\n"
      "_relume() {\n"
      "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]}\n"
      "  COMPREPLY=()\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    " +
      words(fmt::format("{} --help --version", fmt::join(command_names, " "))) +
      "\n"
      "    return\n"
      "  fi\n"
      "  case ${COMP_WORDS[1]} in\n";
  for (const Command& command : commands) text += command_case(command, names);
  return text + "  esac\n}\ncomplete -F _relume relume\n";
}

}  // namespace relume::cli
