#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/file_roles.h"
#include "cli/scene_source.h"
#include "files/extension.h"
#include "relume/scene_io.h"

namespace relume::cli {
namespace {

struct ExportOptions {
  std::string scene;
  std::string output;
};

int run_export(const ExportOptions& options, const Verbosity& verbosity) {
  if (options.output.empty()) throw UsageError("export needs -o FILE; see relume export --help");
  const std::filesystem::path file = options.output;
  const std::string extension = lower_extension(file);
  if (extension != ".gltf" && extension != ".glb" && extension != ".pbrt") {
    throw UsageError(
        fmt::format("{}: scenes are written as .gltf, .glb or .pbrt; choose one of these extensions", options.output));
  }
  check_output_file(file);
  FileRoles roles;
  roles.reads("SCENE", options.scene);
  roles.writes("-o", file);
  const Scene scene = open_scene(options.scene, !verbosity.quiet);
  roles.reads("SCENE", scene.source_files);
  warn_all(verbosity, scene);
  warn_all(verbosity, write_scene(file, scene), {file});
  log_info(verbosity, fmt::format("wrote {}", options.output));
  return kExitDone;
}

}  // namespace

Command export_command(Verbosity& verbosity) {
  const auto options = std::make_shared<ExportOptions>();
  Command command{
      .name = "export",
      .summary = "Write a scene as glTF or for pbrt-v4.",
      .examples = {{"relume export cornell -o cornell.glb", "a built-in scene as one file"},
                   {"relume export bistro.fbx -o bistro.gltf",
                    "any scene that relume reads, as .gltf, .bin and images"},
                   {"relume export scene.glb -o scene.pbrt", "for pbrt-v4, with meshes and images in a folder"}},
      .arguments = {{"SCENE", &options->scene, "Built-in scene (`relume scenes`) or file", true, Completion::scene}},
      .options = {{{"output", &options->output, "File to write: .gltf, .glb or .pbrt"}, "FILE", 'o', Completion::file}},
      .setting_groups = {},
      .setting_flags = nullptr,
      .run = [options, &verbosity] { return run_export(*options, verbosity); },
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
