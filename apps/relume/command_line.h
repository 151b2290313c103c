// From argv to a command that runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "command.h"

namespace relume::cli {

/// Runs what the arguments (without the program's name) ask for and returns the exit code. Problems become one sentence
/// on standard error; results go to standard output, and a failure to write there is a failure.
int run_program(const std::vector<Command>& commands, const std::vector<std::string>& arguments);

/// Assigns the arguments (without the command's name) to the command's variables. Returns false if help was asked for.
/// Throws UsageError.
bool parse_arguments(const Command& command, const std::vector<std::string>& arguments);

/// `relume COMMAND --help`: examples first.
std::string help_text(const Command& command);
/// `relume --help`.
std::string overview_text(const std::vector<Command>& commands);

}  // namespace relume::cli
