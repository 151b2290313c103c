#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "cli/command_line.h"

namespace relume::cli {
namespace {

constexpr size_t kHelpWidth = 100;  // characters per line
constexpr size_t kHelpColumn = 30;  // column of the explanations

/// `text` wrapped at words; all lines except the first are indented to kHelpColumn.
std::string wrap(std::string_view text) {
  std::string result;
  size_t column = kHelpColumn;
  while (!text.empty()) {
    const size_t length = std::min(text.find(' '), text.size());
    if (column > kHelpColumn) {
      const bool fits = column + 1 + length <= kHelpWidth;
      result += fits ? " " : "\n" + std::string(kHelpColumn, ' ');
      column = fits ? column + 1 : kHelpColumn;
    }
    result += text.substr(0, length);
    column += length;
    text.remove_prefix(std::min(length + 1, text.size()));
  }
  return result;
}

/// "  left      explanation", with the explanation on the next line if `left` is too long.
std::string row(const std::string& left, std::string_view explanation) {
  const std::string head = "  " + left;
  if (head.size() + 2 > kHelpColumn) return fmt::format("{}\n{:{}}{}\n", head, "", kHelpColumn, wrap(explanation));
  return fmt::format("{:{}}{}\n", head, kHelpColumn, wrap(explanation));
}

std::string upper_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

std::string explained(const Setting& setting, const std::string& left) {
  const std::string now = to_string(setting);
  const bool tells_default = !now.empty() && now != "false";
  return row(left, tells_default ? fmt::format("{} [{}]", setting.help, now) : std::string(setting.help));
}

std::string option_row(const Option& option) {
  const Setting& setting = option.setting;
  std::string left = option.letter != 0 ? fmt::format("-{}, --{}", option.letter, setting.name) : "--" + setting.name;
  const std::string value = value_name(setting, option.value_name);
  if (!value.empty()) left += " " + value;
  return explained(setting, left);
}

std::string setting_row(const Setting& setting) {
  const std::string value = value_name(setting, "");
  return explained(setting, value.empty() ? "--[no-]" + setting.name : fmt::format("--{} {}", setting.name, value));
}

std::string usage_line(const Command& command) {
  std::string text = fmt::format("relume {}", command.name);
  for (const Argument& argument : command.arguments) {
    const char* more = argument.repeats ? "…" : "";
    text += argument.required ? fmt::format(" {}{}", argument.name, more) : fmt::format(" [{}{}]", argument.name, more);
  }
  if (!command.options.empty()) text += " [OPTIONS]";
  return text;
}

}  // namespace

std::string value_name(const Setting& setting, std::string_view given) {
  if (!given.empty()) return std::string(given);
  if (std::holds_alternative<bool*>(setting.value)) return {};
  if (std::holds_alternative<int*>(setting.value)) return "N";
  if (std::holds_alternative<float*>(setting.value)) return setting.traits.unit == "s" ? "DURATION" : "X";
  if (const auto* number = std::get_if<OptionalNumberRef>(&setting.value)) return fmt::format("{}|X", number->word);
  if (const auto* choices = std::get_if<ChoiceRef>(&setting.value)) {
    return fmt::format("{}", fmt::join(choices->names, "|"));
  }
  return upper_case(setting.name);
}

namespace {

/// The text before the options.
std::string introduction(const Command& command) {
  std::string text = fmt::format("{}\n\nExamples:\n", command.summary);
  for (const Example& example : command.examples)
    text += fmt::format("  {}\n      {}\n", example.line, example.meaning);
  text += fmt::format("\nUsage: {}\n", usage_line(command));
  if (!command.arguments.empty()) text += "\nArguments:\n";
  for (const Argument& argument : command.arguments) text += row(std::string(argument.name), argument.help);
  return text + "\nOptions:\n";
}

/// The row of the option or setting with this name.
std::string row_of(const Command& command, std::string_view name) {
  for (const Option& option : command.options) {
    if (option.setting.name == name) return option_row(option);
  }
  return setting_row(require_setting(flatten(command.setting_groups), std::string(name), std::string(name)));
}

}  // namespace

std::string help_text(const Command& command) {
  if (command.essentials.empty()) return full_help_text(command);
  std::string text = introduction(command);
  for (const std::string_view name : command.essentials) text += row_of(command, name);
  const size_t all = command.options.size() + flatten(command.setting_groups).size();
  return text + row("-h, --help", "Show this help") + row("--help-all", fmt::format("Show all {} options", all));
}

std::string full_help_text(const Command& command) {
  std::string text = introduction(command);
  for (const Option& option : command.options) text += option_row(option);
  if (command.essentials.empty()) {
    text += row("-h, --help", "Show this help");
  } else {
    text += row("-h, --help", "Show the most common options") + row("--help-all", "Show this help");
  }
  for (const SettingGroup& group : command.setting_groups) {
    text += fmt::format("\n{}:\n", group.title);
    for (const Setting& setting : group.settings) text += setting_row(setting);
  }
  return text;
}

const std::vector<Example>& overview_examples() {
  static const std::vector<Example> examples = {
      {"relume render cornell -o out.png", "a built-in scene, 64 samples per pixel"},
      {"relume render scene.glb -o out.exr --spp 256 --aov albedo,normal,depth", "linear radiance with layers"},
      {"relume info scene.glb", "counts, cameras, extent, memory, warnings"},
  };
  return examples;
}

std::string overview_text(const std::vector<Command>& commands) {
  std::string text = "relume renders scenes by path tracing.\n\nExamples:\n";
  for (const Example& example : overview_examples()) text += fmt::format("  {}\n", example.line);
  text += "\nUsage: relume COMMAND …\n\nCommands:\n";
  for (const Command& command : commands) text += row(std::string(command.name), command.summary);
  text += "\nOptions:\n" + row("-h, --help", "Show this help; `relume COMMAND --help` explains a command") +
          row("--version", "Show the version");
  return text;
}

std::vector<Option> verbosity_options(Verbosity& verbosity) {
  return {
      {{"quiet", &verbosity.quiet, "Print only warnings and errors to standard error"}, "", 'q'},
      {{"verbose", &verbosity.verbose, "Print more to standard error"}, "", 'v'},
  };
}

}  // namespace relume::cli
