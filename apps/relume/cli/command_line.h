// Parses argv and runs a command.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

/// Runs the command in the arguments (without the program's name) and returns the exit code. Problems are reported as
/// one sentence on standard error. Results go to standard output; a write error there is a failure.
int run_program(const std::vector<Command>& commands, const std::vector<std::string>& arguments);

enum class Request { run, help, help_all };

/// Assigns the arguments (without the command's name) to the command's variables, unless they request help. Throws
/// UsageError.
Request parse_arguments(const Command& command, const std::vector<std::string>& arguments);

inline constexpr std::string_view kProgramSummary = "Render scenes by path tracing.";
inline constexpr std::string_view kProgramDescription =
    "relume is a real-time path tracer for the processor, unbiased by default. It renders glTF scenes to images and "
    "animations or in an interactive window, and reuses samples across pixels, frames and paths. The same command "
    "gives the same bits with any number of threads.";
const std::vector<Example>& overview_examples();

/// The value in help and manual pages: "N", "X", "a|b", "TEXT"; empty for booleans. `given` has priority.
std::string value_name(const Setting& setting, std::string_view given);

/// `relume COMMAND --help`: examples first, then the essentials.
std::string help_text(const Command& command);
/// `relume COMMAND --help-all`: every option and setting.
std::string full_help_text(const Command& command);
/// `relume --help`.
std::string overview_text(const std::vector<Command>& commands);

}  // namespace relume::cli
