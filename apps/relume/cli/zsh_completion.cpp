#include <fmt/format.h>

#include "cli/completion.h"

namespace relume::cli {
namespace {

/// Quotes the text in single quotes.
std::string shell_quoted(std::string_view text) {
  std::string result;
  for (const char c : text) result += c == '\'' ? "'\\''" : std::string(1, c);
  return "'" + result + "'";
}

/// Escapes each of `special` with a backslash.
std::string escaped(std::string_view text, std::string_view special) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != special.npos) result += '\\';
    result += c;
  }
  return result;
}

/// The action of an _arguments specification. A space: the value has no completion.
std::string action(const Offer& offer) {
  const std::string list = fmt::format("{}", fmt::join(offer.words, " "));
  if (!offer.files) return list.empty() ? " " : fmt::format("({})", list);
  return list.empty() ? "_files" : fmt::format("{{compadd {}; _files}}", list);
}

std::string explanation(const Setting& setting) { return fmt::format("[{}]", escaped(setting.help, "\\[]")); }

std::string option_lines(const Option& option, const CompletionNames& names) {
  const std::string flag = "--" + option.setting.name;
  const std::string letter = option.letter != 0 ? fmt::format("-{}", option.letter) : "";
  const std::string help = explanation(option.setting);
  const std::optional<Offer> offer = value_offer(option, names);
  if (!offer) {
    const std::string negation = "--no-" + option.setting.name;
    const std::string others = fmt::format("({} {} {})", letter, flag, negation);
    std::string text = fmt::format("        {} \\\n", shell_quoted(others + flag + help));
    if (!letter.empty()) text += fmt::format("        {} \\\n", shell_quoted(others + letter + help));
    return text +
           fmt::format("        {} \\\n", shell_quoted(fmt::format("{}{}[Turn off {}]", others, negation, flag)));
  }
  const std::string name = option.value_name.empty() ? "value" : escaped(option.value_name, "\\:");
  const std::string value = fmt::format(":{}:{}", name, action(*offer));
  const std::string others = option.repeats ? "*" : fmt::format("({} {})", letter, flag);
  std::string text = fmt::format("        {} \\\n", shell_quoted(others + flag + "=" + help + value));
  if (!letter.empty()) text += fmt::format("        {} \\\n", shell_quoted(others + letter + "+" + help + value));
  return text;
}

std::string argument_line(const Argument& argument, const CompletionNames& names) {
  const std::string place = argument.repeats ? "*:" : argument.required ? ":" : "::";
  return fmt::format("        {} \\\n", shell_quoted(fmt::format("{}{}:{}", place, argument.name,
                                                                 action(offer_of(argument.completion, names)))));
}

std::string command_case(const Command& command, const CompletionNames& names) {
  std::string text = fmt::format("    {})\n      _arguments -s \\\n", command.name);
  for (const Option& option : all_options(command)) text += option_lines(option, names);
  for (const Argument& argument : command.arguments) text += argument_line(argument, names);
  if (!command.essentials.empty()) text += "        '(- *)--help-all[Show all options]' \\\n";
  return text + "        '(- *)'{-h,--help}'[Show help]'\n      ;;\n";
}

}  // namespace

std::string zsh_completion(const std::vector<Command>& commands, const CompletionNames& names) {
  std::string text =
      "#compdef relume\n"
      "# Completion of relume for zsh; made by `relume completion zsh`.\n"
      "_relume() {\n"
      "  local curcontext=$curcontext state line\n"
      "  local -A opt_args\n"
      "  local -a commands=(\n";
  for (const Command& command : commands) {
    text += fmt::format("    {}\n", shell_quoted(fmt::format("{}:{}", command.name, command.summary)));
  }
  text +=
      "  )\n"
      "  _arguments -C '(- *)'{-h,--help}'[Show help]' '(- *)--version[Show the version]' \\\n"
      "    ':command:->command' '*::argument:->argument'\n"
      "  if [[ $state == command ]]; then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  [[ $state == argument ]] || return\n"
      "  curcontext=${curcontext%:*:*}:relume-$words[1]:\n"
      "  case $words[1] in\n";
  for (const Command& command : commands) text += command_case(command, names);
  return text +
         "  esac\n"
         "}\n"
         "# In $fpath this file is the function's body; when sourced, it registers the function.\n"
         "if [[ $funcstack[1] == _relume ]]; then _relume \"$@\"; else compdef _relume relume; fi\n";
}

}  // namespace relume::cli
