#include "cli/viewer_start.h"

#include <filesystem>
#include <future>
#include <utility>

#include "cli/console.h"
#include "cli/platform.h"
#include "cli/scene_source.h"
#include "core/clock.h"
#include "scene_io/scene_format.h"
#include "viewer/model/start_settings.h"

namespace relume::cli {

std::vector<Option> viewer_options(ViewerOptions& o, std::string_view ocio_help) {
  return {
      {{"preset", &o.preset, "Named settings; flags override them; without a chosen technique, interactive"},
       "NAME",
       0,
       Completion::preset},
      {{"settings", &o.settings_file, "Settings from a JSON file, or from an EXR that relume rendered"},
       "FILE",
       0,
       Completion::file},
      {{"ocio", &o.ocio, ocio_help}, "CONFIG:VIEW", 0, Completion::file},
      {{"target",
        &o.target_hz,
        "Rendered frames per second to hold by scaling the resolution",
        {.min = 1, .max = 240}}},
      {{"watch", &o.watch, "Reload the scene when its files change, with the same camera and settings"}},
  };
}

Command viewer_command(ViewerOptions& viewer, AllSettings& defaults, std::vector<Option> options,
                       Verbosity& verbosity) {
  Command command{
      .name = "",
      .summary = "",
      .examples = {},
      .arguments = {{"SCENE", &viewer.scene, scene_format_names() + " file, or a built-in scene (default: cornell)",
                     false, Completion::scene}},
      .options = std::move(options),
      .setting_groups = setting_groups(defaults),
      .setting_flags = &viewer.flags,
      .run = {},
      .folders = {kBookmarkFolder},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

SettingSources setting_sources(const ViewerOptions& options) {
  SettingSources sources{.preset = options.preset, .file = options.settings_file, .flags = options.flags};
  resolve(sources);
  return sources;
}

ViewerStart load_viewer_start(const ViewerOptions& options, SettingSources sources, const Verbosity& verbosity,
                              const std::function<void(const Scene&, const AllSettings&)>& check) {
  const double start_s = now_s();
  const auto read_from = std::filesystem::file_time_type::clock::now();
  // On a low-priority thread, since rendering later uses the threads that it starts: interface and network keep
  // priority.
  auto loading = std::async(std::launch::async, [&] {
    lower_thread_priority();
    return open_scene(options.scene);
  });
  Scene scene = loading.get();
  const double load_s = now_s() - start_s;
  sources.scene_json = scene.settings_json;
  sources.scene_place = options.scene;
  ViewerStart start{
      .scene = nullptr, .settings = viewer::resolve_start(sources), .chooses_size = viewer::chooses_size(sources)};
  if (check) check(scene, start.settings);
  choose_variant(scene, start.settings.scene.variant);
  warn_all(verbosity, scene);
  start.scene = std::make_shared<const viewer::LoadedScene>(
      viewer::LoadedScene{options.scene, std::move(scene), load_s, read_from});
  return start;
}

}  // namespace relume::cli
