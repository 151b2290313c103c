#include "cli/command_line.h"

#include <cstdio>
#include <exception>
#include <map>
#include <new>
#include <optional>

#include <fmt/format.h>
#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "cli/console.h"
#include "cli/version.h"
#include "ranks/launcher.h"
#include "relume/error.h"
#include "settings/nearest_name.h"

namespace relume::cli {
namespace {

bool is_flag(const Setting& setting) { return std::holds_alternative<bool*>(setting.value); }

/// "--name", "-n,--name", and for booleans "--name,!--no-name".
std::string names_of(const Setting& setting, char letter) {
  std::string names = "--" + setting.name;
  if (letter != 0) names.insert(0, std::string{'-', letter, ','});
  if (is_flag(setting)) names += ",!--no-" + setting.name;
  return names;
}

CLI::Option* declare(CLI::App& app, const Setting& setting, char letter, bool repeats = false) {
  const std::string names = names_of(setting, letter);
  CLI::Option* option = is_flag(setting) ? app.add_flag(names) : app.add_option(names)->expected(1);
  if (repeats) return option->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

std::vector<std::string> option_names(const Command& command) {
  std::vector<std::string> names = {"--help", "--help-all"};
  for (const Option& option : command.options) names.push_back("--" + option.setting.name);
  for (const Setting& setting : flatten(command.setting_groups)) names.push_back("--" + setting.name);
  return names;
}

/// Reports arguments that CLI11 could not assign, in one sentence.
[[noreturn]] void refuse_extras(const Command& command, const std::vector<std::string>& extras) {
  for (const std::string& extra : extras) {
    if (!extra.starts_with("-")) continue;
    const std::string name = extra.substr(0, extra.find('='));
    const std::string nearest = nearest_name(name, option_names(command));
    throw UsageError(fmt::format("{} has no option {}{}", command.name, name,
                                 nearest.empty() ? fmt::format("; see relume {} --help", command.name)
                                                 : fmt::format("; did you mean {}?", nearest)));
  }
  throw UsageError(
      fmt::format("{}: unexpected argument '{}'; see relume {} --help", command.name, extras.front(), command.name));
}

/// The setting under the name of its flag.
Setting as_flag(Setting setting) {
  setting.name.insert(0, "--");
  return setting;
}

/// Options parsed by CLI11, with their declarations.
struct Declared {
  std::vector<std::pair<CLI::Option*, const Argument*>> arguments;
  std::vector<std::pair<CLI::Option*, const Option*>> options;
  std::vector<std::pair<CLI::Option*, const Setting*>> settings;
};

void take_values(const Command& command, const Declared& declared) {
  for (const auto& [option, argument] : declared.arguments) {
    if (option->count() > 0 && argument->values) *argument->values = option->results();
    if (option->count() > 0 && argument->value) {
      *argument->value = fmt::format("{}", fmt::join(option->results(), ","));
    }
    if (argument->required && (argument->value ? argument->value->empty() : argument->values->empty())) {
      throw UsageError(fmt::format("{} needs {}; see relume {} --help", command.name, argument->name, command.name));
    }
  }
  try {
    for (const auto& [option, declaration] : declared.options) {
      if (option->count() == 0) continue;
      const std::vector<std::string> texts = option->results();
      assign(as_flag(declaration->setting),
             declaration->repeats ? fmt::format("{}", fmt::join(texts, ",")) : texts.back(), "");
    }
    for (const auto& [option, setting] : declared.settings) {
      if (option->count() == 0) continue;
      parse_value(as_flag(*setting), option->results().back(), "");
      command.setting_flags->emplace_back(setting->name, option->results().back());
    }
  } catch (const UsageError&) {
    throw;
  } catch (const Error& error) {
    throw UsageError(error.what());
  }
}

/// Whether the command may run on this rank of a launcher. Only some share their work among ranks: the processes of
/// others would write the same files. Throws UsageError on rank 0.
bool ranks_allow(const Command& command) {
  const std::optional<ranks::Launch> launch = ranks::find_launch();
  const bool shares = command.name == "render" || command.name == "compare" || command.name == "experiment";
  if (shares || !launch || launch->size < 2) return true;
  if (launch->rank > 0) return false;
  throw UsageError(fmt::format("{} runs as one process, but {} ranks were started; start it without mpirun",
                               command.name, launch->size));
}

int run_command(const std::vector<Command>& commands, const std::vector<std::string>& arguments) {
  const std::string& name = arguments.front();
  std::vector<std::string> names;
  for (const Command& command : commands) {
    names.emplace_back(command.name);
    if (command.name != name) continue;
    const Request request = parse_arguments(command, {arguments.begin() + 1, arguments.end()});
    if (request == Request::run) return ranks_allow(command) ? command.run() : kExitUsage;
    std::fputs((request == Request::help ? help_text(command) : full_help_text(command)).c_str(), stdout);
    return kExitDone;
  }
  if (name.starts_with("-"))
    throw UsageError(fmt::format("unknown option {} without a command; see relume --help", name));
  throw UsageError(fmt::format("there is no command '{}'{}", name, suggestion(name, names)));
}

int dispatch(const std::vector<Command>& commands, const std::vector<std::string>& arguments) {
  if (arguments.empty()) {
    std::fputs(overview_text(commands).c_str(), stderr);
    return kExitUsage;
  }
  const std::string& first = arguments.front();
  if (first == "--version") {
    std::puts(kVersionLine);
    return kExitDone;
  }
  if (first == "--help" || first == "-h" || first == "help") {
    if (arguments.size() > 1) return run_command(commands, {arguments[1], "--help"});
    std::fputs(overview_text(commands).c_str(), stdout);
    return kExitDone;
  }
  return run_command(commands, arguments);
}

int report(const char* sentence, int exit_code) {
  std::fputs(fmt::format("relume: {}\n", printable(sentence)).c_str(), stderr);
  return exit_code;
}

}  // namespace

Request parse_arguments(const Command& command, const std::vector<std::string>& arguments) {
  CLI::App app;
  app.set_help_all_flag("--help-all");
  Declared declared;
  for (const Argument& argument : command.arguments) {
    CLI::Option* option = app.add_option(std::string(argument.name));
    // CLI11 2.1 passes nothing to an optional positional that does not allow extra arguments.
    argument.repeats ? option->expected(0, CLI::detail::expected_max_vector_size)->allow_extra_args()
                     : option->expected(1);
    declared.arguments.emplace_back(option, &argument);
  }
  for (const Option& option : command.options) {
    declared.options.emplace_back(declare(app, option.setting, option.letter, option.repeats), &option);
  }
  for (const SettingGroup& group : command.setting_groups) {
    for (const Setting& setting : group.settings) declared.settings.emplace_back(declare(app, setting, 0), &setting);
  }
  app.allow_extras();
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 takes them in reverse
  } catch (const CLI::CallForHelp&) {
    return Request::help;
  } catch (const CLI::CallForAllHelp&) {
    return Request::help_all;
  } catch (const CLI::ParseError& error) {
    throw UsageError(fmt::format("{}: {}", command.name, error.what()));
  }
  if (!app.remaining().empty()) refuse_extras(command, app.remaining());
  take_values(command, declared);
  return Request::run;
}

int run_program(const std::vector<Command>& commands, const std::vector<std::string>& arguments) {
  try {
    const int exit_code = dispatch(commands, arguments);
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
      return report("standard output cannot be written; check the free space", kExitFailed);
    }
    return exit_code;
  } catch (const UsageError& error) {
    return report(error.what(), kExitUsage);
  } catch (const DeviceMemoryError& error) {
    return report(error.what(), kExitFailed);
  } catch (const std::bad_alloc&) {
    return report("out of memory; try a smaller --width and --height or a smaller scene", kExitFailed);
  } catch (const std::exception& error) {
    return report(error.what(), kExitFailed);
  }
}

}  // namespace relume::cli
