// Shell completion, from the commands' declarations.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

/// Possible names for values of these kinds.
struct CompletionNames {
  std::vector<std::string> scenes;
  std::vector<std::string> presets;
  std::vector<std::string> experiments;
  std::vector<std::string> commands = {};
};

inline constexpr std::string_view kShells[] = {"bash", "zsh", "fish"};

/// Completions for a value.
struct Offer {
  std::vector<std::string> words;
  bool files = false;
};
Offer offer_of(Completion completion, const CompletionNames& names);
/// Completions for the option's value; std::nullopt if it takes no value.
std::optional<Offer> value_offer(const Option& option, const CompletionNames& names);

/// The command's options and settings.
std::vector<Option> all_options(const Command& command);

/// A script for bash; with the package bash-completion it belongs into share/bash-completion/completions/relume.
std::string bash_completion(const std::vector<Command>& commands, const CompletionNames& names);
/// For a folder in zsh's $fpath, under the name _relume; may also be sourced.
std::string zsh_completion(const std::vector<Command>& commands, const CompletionNames& names);
/// For a folder in $fish_complete_path, under the name relume.fish.
std::string fish_completion(const std::vector<Command>& commands, const CompletionNames& names);

}  // namespace relume::cli
