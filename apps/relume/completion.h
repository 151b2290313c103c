// Completion of the command line by shells, from the commands' declarations.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command.h"

namespace relume::cli {

/// Names that values of these kinds can have.
struct CompletionNames {
  std::vector<std::string> scenes;
  std::vector<std::string> presets;
  std::vector<std::string> experiments;
  std::vector<std::string> commands = {};
};

inline constexpr std::string_view kShells[] = {"bash", "zsh", "fish"};

/// What a shell offers for a value.
struct Offer {
  std::vector<std::string> words;
  bool files = false;
};
Offer offer_of(Completion completion, const CompletionNames& names);
/// For the option's value; none if it takes no value.
std::optional<Offer> value_offer(const Option& option, const CompletionNames& names);

/// The command's options and settings.
std::vector<Option> all_options(const Command& command);

/// A script for bash; with the package bash-completion it belongs into share/bash-completion/completions/relume.
std::string bash_completion(const std::vector<Command>& commands, const CompletionNames& names);
/// For a folder in zsh's $fpath, under the name _relume; may be sourced, too.
std::string zsh_completion(const std::vector<Command>& commands, const CompletionNames& names);
/// For a folder in $fish_complete_path, under the name relume.fish.
std::string fish_completion(const std::vector<Command>& commands, const CompletionNames& names);

}  // namespace relume::cli
