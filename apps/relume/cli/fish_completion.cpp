#include <fmt/format.h>

#include "cli/completion.h"

namespace relume::cli {
namespace {

/// Quotes the text in single quotes.
std::string shell_quoted(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    result += c;
  }
  return "'" + result + "'";
}

std::string offer_flags(const Offer& offer) {
  const std::string words =
      offer.words.empty() ? "" : fmt::format(" -a {}", shell_quoted(fmt::format("{}", fmt::join(offer.words, " "))));
  return (offer.files ? " -F" : " -f") + words;
}

std::string command_lines(const Command& command, const CompletionNames& names) {
  const std::string start = fmt::format("complete -c relume -n '__relume_command {}'", command.name);
  std::string text = fmt::format("complete -c relume -n __fish_use_subcommand -a {} -d {}\n", command.name,
                                 shell_quoted(command.summary));
  for (const Option& option : all_options(command)) {
    const std::string letter = option.letter != 0 ? fmt::format(" -s {}", option.letter) : "";
    const std::optional<Offer> offer = value_offer(option, names);
    text += fmt::format("{} -l {}{}{} -d {}\n", start, option.setting.name, letter,
                        offer ? " -r" + offer_flags(*offer) : "", shell_quoted(option.setting.help));
    if (!offer) text += fmt::format("{} -l no-{}\n", start, option.setting.name);
  }
  text += fmt::format("{} -s h -l help -d 'Show help'\n", start);
  if (!command.essentials.empty()) text += fmt::format("{} -l help-all -d 'Show all options'\n", start);
  for (const Argument& argument : command.arguments) {
    text += fmt::format("{}{}\n", start, offer_flags(offer_of(argument.completion, names)));
  }
  return text;
}

}  // namespace

std::string fish_completion(const std::vector<Command>& commands, const CompletionNames& names) {
  std::string text =
      "# Completion of relume for fish; made by `relume completion fish`.\n"
      "function __relume_command --argument-names name --description 'Whether the command is this one'\n"
      "    set -l words (commandline -opc)\n"
      "    test \"$words[2]\" = $name\n"
      "end\n"
      "complete -c relume -f\n"
      "complete -c relume -n __fish_use_subcommand -s h -l help -d 'Show help'\n"
      "complete -c relume -n __fish_use_subcommand -l version -d 'Show the version'\n";
  for (const Command& command : commands) text += command_lines(command, names);
  return text;
}

}  // namespace relume::cli
