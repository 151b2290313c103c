#include "viewer/view_job.h"

#include <cstdio>
#include <cstdlib>
#include <utility>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/image.h"
#include "cli/ocio_option.h"
#include "files/atomic_file.h"
#include "render/settings.h"
#include "viewer/app.h"
#include "viewer/model/script.h"
#include "viewer/window.h"

namespace relume::cli {
namespace {

std::vector<viewer::ScriptStep> load_script(const std::string& file) {
  if (file.empty()) return {};
  const std::vector<std::byte> bytes = read_file(file, 1 << 24);
  return viewer::parse_script({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
}

/// The file that a step reads, or a name that is no file; empty for other steps.
std::string input_of(const viewer::ScriptStep& step) {
  if (step.verb == "drop") return step.words[0];
  const bool sets = step.verb == "set" || step.verb == "set-b" || step.verb == "try";
  return sets && step.words[0] == "env" ? step.words[1] : "";
}

std::string output_of(const viewer::ScriptStep& step) {
  return step.verb == "save" || step.verb == "save-view" || step.verb == "screenshot" ? step.words[0] : "";
}

/// Adds the files of the steps in order: a step may read what an earlier one writes. Throws Error.
void add_steps(const std::vector<viewer::ScriptStep>& steps, const std::string& script, FileRoles& roles) {
  for (const viewer::ScriptStep& step : steps) {
    const std::string role = fmt::format("{}:{}: {}", script, step.line, step.verb);
    if (const std::string input = input_of(step); !roles.has_output(input)) roles.reads(role, input);
    const std::string output = output_of(step);
    if (output.empty()) continue;
    try {
      check_output_file(output);
    } catch (const Error& error) {
      throw Error(fmt::format("{}: {}", role, error.what()));
    }
    roles.writes(role, output);
  }
}

/// Throws Error if a file has two roles, or an output of the script cannot be written.
FileRoles roles_of(const ViewOptions& options, const std::vector<viewer::ScriptStep>& steps) {
  FileRoles roles;
  roles.reads("SCENE", options.scene);
  roles.reads("--settings", options.settings_file);
  roles.reads("--script", options.script);
  roles.reads("--ocio", ocio_config(options.ocio));
  add_steps(steps, options.script, roles);
  roles.writes("--screenshot", options.screenshot);
  return roles;
}

}  // namespace

int run_view(const ViewOptions& options, const Verbosity& verbosity) {
  const SettingSources sources = setting_sources(options);
  if (!options.screenshot.empty()) check_image_file(options.screenshot, {});
  std::vector<viewer::ScriptStep> steps = load_script(options.script);
  FileRoles roles = roles_of(options, steps);
  auto ocio_view = make_ocio_view(options.ocio, options.flags);
  if (ocio_view) roles.reads("--ocio", ocio_view->files());
  viewer::Window::require_display();
  const viewer::OcioDisplay ocio(std::move(ocio_view));
  const ViewerStart start =
      load_viewer_start(options, sources, verbosity, [&](const Scene& scene, const auto& settings) {
        roles.reads("SCENE", scene.source_files);
        roles.reads("--env", settings.scene.env);
      });
  if (ocio.view() && !ocio.view()->note().empty()) log_info(verbosity, ocio.view()->note());
  viewer::App app(options, start.settings, start.chooses_size, viewer::ScriptPlayer(std::move(steps), options.script),
                  start.scene, ocio);
  app.run();
  if (app.loading()) {
    // A scene that is still loading will not be shown: exits without waiting for it.
    std::fflush(nullptr);
    std::_Exit(kExitDone);
  }
  return kExitDone;
}

}  // namespace relume::cli
