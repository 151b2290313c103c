#include "completion.h"

#include <fmt/format.h>

namespace relume::cli {
namespace {

std::string words(const std::string& list) { return fmt::format("COMPREPLY=($(compgen -W '{}' -- \"$cur\"))", list); }

/// Bash that fills COMPREPLY with values of this kind.
std::string completion_script(Completion completion, const CompletionNames& names) {
  switch (completion) {
    case Completion::file: return "compopt -o filenames; COMPREPLY=($(compgen -f -- \"$cur\"))";
    case Completion::scene:
      return fmt::format("compopt -o filenames; COMPREPLY=($(compgen -W '{}' -- \"$cur\") $(compgen -f -- \"$cur\"))",
                         fmt::join(names.scenes, " "));
    case Completion::experiment: return words(fmt::format("list run {}", fmt::join(names.experiments, " ")));
    case Completion::preset: return words(fmt::format("{}", fmt::join(names.presets, " ")));
    case Completion::none: break;
  }
  return "COMPREPLY=()";
}

/// The same for the option's value; empty if it takes none.
std::string value_script(const Option& option, const CompletionNames& names) {
  if (std::holds_alternative<bool*>(option.setting.value)) return {};
  if (const auto* choices = std::get_if<ChoiceRef>(&option.setting.value)) {
    return words(fmt::format("{}", fmt::join(choices->names, " ")));
  }
  return completion_script(option.completion, names);
}

/// The options that commands collect rather than assign may be files too: --env.
Completion completion_of(const Setting& setting) {
  return std::holds_alternative<std::string*>(setting.value) && setting.name == "env" ? Completion::file
                                                                                      : Completion::none;
}

std::vector<Option> all_options(const Command& command) {
  std::vector<Option> options = command.options;
  for (const Setting& setting : flatten(command.setting_groups))
    options.push_back({setting, "", 0, completion_of(setting)});
  return options;
}

std::string command_case(const Command& command, const CompletionNames& names) {
  std::string flags = "--help";
  std::string text = fmt::format("    {})\n      case $prev in\n", command.name);
  for (const Option& option : all_options(command)) {
    const std::string flag = "--" + option.setting.name;
    flags += " " + flag;
    const std::string script = value_script(option, names);
    if (script.empty()) flags += " --no-" + option.setting.name;
    const std::string letter = option.letter != 0 ? fmt::format("|-{}", option.letter) : "";
    if (!script.empty()) text += fmt::format("        {}{}) {}; return ;;\n", flag, letter, script);
  }
  text += fmt::format("      esac\n      if [[ $cur == -* ]]; then {}; return; fi\n", words(flags));
  if (!command.arguments.empty()) {
    text += fmt::format("      {}\n", completion_script(command.arguments.front().completion, names));
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
