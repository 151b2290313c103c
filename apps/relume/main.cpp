#include <string>
#include <vector>

#include "cli/command_line.h"
#include "cli/platform.h"

int main(int argc, char** argv) {
  using namespace relume::cli;
  prepare_signals();
  Verbosity verbosity;
  std::vector<Command> commands = {
      render_command(verbosity),  view_command(verbosity),       serve_command(verbosity),  scenes_command(),
      export_command(verbosity),  info_command(verbosity),       metrics_command(),         merge_command(verbosity),
      compare_command(verbosity), experiment_command(verbosity), survey_command(verbosity), settings_command(),
      devices_command(),
  };
  commands.push_back(man_command(commands));
  commands.push_back(completion_command(commands));
  return run_program(commands, {argv + 1, argv + argc});
}
