#include "cli/man_page.h"

#include <algorithm>
#include <cctype>
#include <set>

#include <fmt/format.h>

#include "cli/command_line.h"
#include "cli/roff.h"
#include "cli/version.h"

namespace relume::cli {
namespace {

struct ExitStatus {
  int code;
  std::string_view meaning;
};

constexpr ExitStatus kExitStatuses[] = {
    {kExitDone, "All outputs were written."},
    {kExitFailed, "The command failed; the reason is on standard error."},
    {kExitUsage, "The command line is invalid; nothing was done."},
    {kExitInterrupted, "The command was interrupted. `relume render` then writes the image so far."},
};

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string title(const std::string& name) {
  return fmt::format(
      ".\\\" Made by `relume man` from the declarations in the code.\n.TH {} 1 {} \"{}\" \"User Commands\"\n",
      upper_case(name), RELUME_VERSION_DATE, kVersionLine);
}

/// The section NAME, whose line has no full stop.
std::string name_section(const std::string& name, std::string_view summary) {
  if (summary.ends_with('.')) summary.remove_suffix(1);
  return ".SH NAME\n" + roff_prose(fmt::format("`{}` - {}", name, summary));
}

std::string tagged(const std::string& tag, std::string_view text) {
  return fmt::format(".TP\n{}\n{}", tag, roff_prose(text));
}

std::string usage(const Command& command) {
  std::string text = roff_bold(fmt::format("relume {}", command.name));
  for (const Argument& argument : command.arguments) {
    const std::string name = roff_italic(argument.name) + (argument.repeats ? " ..." : "");
    text += argument.required ? " " + name : fmt::format(" [{}]", name);
  }
  return text + " [" + roff_italic("OPTIONS") + "]\n";
}

/// The help, with the range and default that it omits.
std::string explanation(const Setting& setting) {
  std::string text(setting.help);
  if (!text.ends_with('.')) text += '.';
  const bool is_number = std::holds_alternative<int*>(setting.value) || std::holds_alternative<float*>(setting.value) ||
                         std::holds_alternative<OptionalNumberRef>(setting.value);
  const std::string type = is_number ? describe_type(setting) : "";
  const std::string value = to_string(setting);
  const std::string fallback = value.empty() || value == "false" ? "" : "default " + value;
  std::string facts = type + (type.empty() || fallback.empty() ? "" : "; ") + fallback;
  if (facts.empty()) return text;
  facts[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(facts[0])));
  return fmt::format("{} {}.", text, facts);
}

std::string option_entry(const Option& option, bool shows_negation) {
  const Setting& setting = option.setting;
  std::string tag = option.letter != 0 ? roff_bold(fmt::format("-{}", option.letter)) + ", " : "";
  tag += roff_bold("--" + setting.name);
  const std::string value = value_name(setting, option.value_name);
  if (!value.empty()) {
    tag += " " + roff_italic(value);
  } else if (shows_negation) {
    tag += ", " + roff_bold("--no-" + setting.name);
  }
  return tagged(tag, explanation(setting));
}

std::string options_section(const Command& command) {
  std::string text = ".SH OPTIONS\n";
  for (const Option& option : command.options) text += option_entry(option, false);
  text += tagged(roff_bold("-h") + ", " + roff_bold("--help"), "Show a summary of the command.");
  if (!command.essentials.empty())
    text += tagged(roff_bold("--help-all"), "Show a summary of the command with all of its options.");
  for (const SettingGroup& group : command.setting_groups) {
    text += fmt::format(".SS \"{}\"\n{}", group.title, roff_prose(group.summary));
    for (const Setting& setting : group.settings) text += option_entry({setting}, true);
  }
  return text;
}

std::string examples_section(const std::vector<Example>& examples) {
  std::string text = ".SH EXAMPLES\n";
  for (const Example& example : examples) text += tagged(roff_bold(example.line), example.meaning);
  return text;
}

std::string exit_section() {
  std::string text = ".SH EXIT STATUS\n";
  for (const ExitStatus& status : kExitStatuses) text += tagged(roff_bold(std::to_string(status.code)), status.meaning);
  return text;
}

/// FILES and ENVIRONMENT; empty if the commands keep no files.
std::string folders_section(const std::vector<UserFolder>& folders) {
  if (folders.empty()) return {};
  std::string files = ".SH FILES\n";
  std::string environment = ".SH ENVIRONMENT\n";
  for (const UserFolder& folder : folders) {
    files += tagged(roff_italic(fmt::format("~/{}/{}", folder.below_home, folder.path)), folder.contents);
    environment +=
        tagged(roff_bold(folder.variable), fmt::format("The folder used instead of ~/{}.", folder.below_home));
  }
  return environment + files;
}

std::string see_also(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ",\n") + roff_bold(name) + "(1)";
  return ".SH SEE ALSO\n" + text + "\n";
}

}  // namespace

std::string man_page_name(const Command& command) { return fmt::format("relume-{}", command.name); }

std::string man_page(const Command& command, const std::vector<Command>& commands) {
  const std::string name = man_page_name(command);
  std::string text = title(name) + name_section(name, command.summary) + ".SH SYNOPSIS\n" + usage(command) +
                     ".SH DESCRIPTION\n" + roff_prose(command.summary);
  for (const Argument& argument : command.arguments) text += tagged(roff_italic(argument.name), argument.help);
  text +=
      options_section(command) + examples_section(command.examples) + exit_section() + folders_section(command.folders);
  std::vector<std::string> others = {"relume"};
  for (const Command& other : commands) {
    if (other.name != command.name) others.push_back(man_page_name(other));
  }
  return text + see_also(others);
}

std::string man_overview(const std::vector<Command>& commands) {
  const std::string bold_program = roff_bold("relume");
  std::string text = title("relume") + name_section("relume", kProgramSummary) + ".SH SYNOPSIS\n" + bold_program + " " +
                     roff_italic("COMMAND") + " [" + roff_italic("ARGUMENTS") + "] [" + roff_italic("OPTIONS") +
                     "]\n.SH DESCRIPTION\n" + roff_prose(kProgramDescription);
  std::vector<std::string> names;
  std::vector<UserFolder> folders;
  std::set<std::string_view> variables;
  text += ".SH COMMANDS\n";
  for (const Command& command : commands) {
    names.push_back(man_page_name(command));
    text += tagged(roff_bold(names.back()) + "(1)", command.summary);
    for (const UserFolder& folder : command.folders) {
      if (variables.insert(folder.variable).second) folders.push_back(folder);
    }
  }
  text += ".SH OPTIONS\n" +
          tagged(roff_bold("-h") + ", " + roff_bold("--help"), "List the commands; after a command, its options.") +
          tagged(roff_bold("--version"), "Show the version.");
  return text + examples_section(overview_examples()) + exit_section() + folders_section(folders) + see_also(names);
}

}  // namespace relume::cli
