#include <cstdio>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/completion.h"
#include "experiments/experiment.h"
#include "relume/builtin_scenes.h"
#include "render/presets.h"

namespace relume::cli {
namespace {

int run_completion(const std::vector<Command>& commands, const std::string& shell) {
  using Script = std::string (*)(const std::vector<Command>&, const CompletionNames&);
  static const std::map<std::string_view, Script> scripts = {
      {"bash", bash_completion}, {"fish", fish_completion}, {"zsh", zsh_completion}};
  const auto script = scripts.find(shell);
  if (script == scripts.end())
    throw UsageError(fmt::format("there is no completion for '{}'; use {}", shell, fmt::join(kShells, ", ")));
  CompletionNames names;
  for (const Command& command : commands) names.commands.emplace_back(command.name);
  for (const BuiltinSceneInfo& scene : list_builtin_scenes()) names.scenes.push_back(scene.name);
  for (const Preset& preset : presets()) names.presets.emplace_back(preset.name);
  for (const Experiment& experiment : experiments()) names.experiments.emplace_back(experiment.name);
  std::fputs(script->second(commands, names).c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command completion_command(const std::vector<Command>& commands) {
  const auto shell = std::make_shared<std::string>();
  return {
      .name = "completion",
      .summary = "Print a completion script for a shell.",
      .examples = {{"source <(relume completion bash)", "in this shell"},
                   {"relume completion bash > ~/.local/share/bash-completion/completions/relume",
                    "in all later shells"},
                   {"relume completion fish > ~/.config/fish/completions/relume.fish", "the same for fish"}},
      .arguments = {{"SHELL", shell.get(), "bash, zsh or fish", true, Completion::shell}},
      .options = {},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [&commands, shell] { return run_completion(commands, *shell); },
  };
}

}  // namespace relume::cli
