#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "command.h"
#include "completion.h"
#include "experiments/experiment.h"
#include "render/presets.h"
#include "scene/builtin.h"

namespace relume::cli {
namespace {

int run_completion(const std::vector<Command>& commands, const std::string& shell) {
  if (shell != "bash") throw UsageError(fmt::format("there is no completion for '{}', only for bash", shell));
  CompletionNames names;
  for (const BuiltinScene& scene : builtin_scenes()) names.scenes.emplace_back(scene.name);
  for (const Preset& preset : presets()) names.presets.emplace_back(preset.name);
  for (const Experiment& experiment : experiments()) names.experiments.emplace_back(experiment.name);
  std::fputs(bash_completion(commands, names).c_str(), stdout);
  return kExitDone;
}

}  // namespace

Command completion_command(const std::vector<Command>& commands) {
  const auto shell = std::make_shared<std::string>();
  return {
      .name = "completion",
      .summary = "Print a script that completes relume's command line in a shell.",
      .examples = {{"source <(relume completion bash)", "for this shell"},
                   {"relume completion bash > ~/.local/share/bash-completion/completions/relume", "for all to come"}},
      .arguments = {{"SHELL", shell.get(), "bash", true, Completion::none}},
      .options = {},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [&commands, shell] { return run_completion(commands, *shell); },
  };
}

}  // namespace relume::cli
