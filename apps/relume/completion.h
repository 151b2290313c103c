// Completion of the command line by shells, from the commands' declarations.
#pragma once

#include <string>
#include <vector>

#include "command.h"

namespace relume::cli {

/// Names that values of these kinds can have.
struct CompletionNames {
  std::vector<std::string> scenes;
  std::vector<std::string> presets;
  std::vector<std::string> experiments;
};

/// A script for bash; with the package bash-completion it belongs into share/bash-completion/completions/relume.
std::string bash_completion(const std::vector<Command>& commands, const CompletionNames& names);

}  // namespace relume::cli
