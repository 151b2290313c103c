#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "relume/builtin_scenes.h"
#include "scene/material_parameters.h"
#include "scene_io/scene_format.h"

namespace relume::cli {
namespace {

struct ScenesOptions {
  bool names_only = false;
  bool formats = false;
  bool materials = false;
};

int run_scenes(const ScenesOptions& options) {
  if (options.formats) {
    std::fputs(scene_formats_reference().c_str(), stdout);
    return kExitDone;
  }
  if (options.materials) {
    std::fputs(material_parameters_reference().c_str(), stdout);
    return kExitDone;
  }
  for (const BuiltinSceneInfo& scene : list_builtin_scenes())
    std::puts((options.names_only ? scene.name : fmt::format("{:18} {}", scene.name, scene.summary)).c_str());
  return kExitDone;
}

}  // namespace

Command scenes_command() {
  const auto options = std::make_shared<ScenesOptions>();
  return {
      .name = "scenes",
      .summary = "List the built-in scenes.",
      .examples = {{"relume scenes", "names and descriptions"},
                   {"relume scenes --names", "only names, for scripts"},
                   {"relume scenes --formats > docs/scene-formats.md", "the reference page of scene formats"}},
      .arguments = {},
      .options = {{{"names", &options->names_only, "Print only names, one per line"}},
                  {{"formats", &options->formats, "Print the formats of scene files as a Markdown table"}},
                  {{"materials", &options->materials, "Print the parameters of materials as a Markdown table"}}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options] { return run_scenes(*options); },
  };
}

}  // namespace relume::cli
