#include <memory>

#include "cli/command.h"
#include "render/settings.h"
#include "scene_io/scene_format.h"
#include "viewer/view_job.h"

namespace relume::cli {
namespace {

std::vector<Option> declare(ViewOptions& o) {
  return {
      {{"preset", &o.preset, "Named settings; flags override them; without a chosen technique, interactive"},
       "NAME",
       0,
       Completion::preset},
      {{"settings", &o.settings_file, "Settings from a JSON file, or from an EXR that relume rendered"},
       "FILE",
       0,
       Completion::file},
      {{"ocio", &o.ocio,
        "Show the image, and write PNG, through a view of an OpenColorIO configuration. It replaces the tone map of "
        "scene, --preset and --settings"},
       "CONFIG:VIEW",
       0,
       Completion::file},
      {{"target",
        &o.target_hz,
        "Rendered frames per second to hold by scaling the resolution",
        {.min = 1, .max = 240}}},
      {{"watch", &o.watch, "Reload the scene when its files change, with the same camera and settings"}},
      {{"smoke", &o.smoke, "Render this many frames without a window, print a report as JSON and exit", {.min = 0}}},
      {{"screenshot", &o.screenshot, "Write an image of the window before exiting"}, "FILE", 0, Completion::file},
      {{"script", &o.script, "Steps to perform: keys, mouse, settings (docs/viewer.md)"}, "FILE", 0, Completion::file},
  };
}

int run([[maybe_unused]] const ViewOptions& options, [[maybe_unused]] const Verbosity& verbosity) {
#if defined(RELUME_HAS_VIEWER)
  return run_view(options, verbosity);
#else
  throw Error(
      "this relume was built without its viewer; install libglfw3-dev, libimgui-dev and libgl-dev, then configure "
      "and build again (scripts/build does both)");
#endif
}

}  // namespace

Command view_command(Verbosity& verbosity) {
  // Both live as long as the command.
  const auto options = std::make_shared<ViewOptions>();
  const auto defaults = std::make_shared<AllSettings>();
  Command command{
      .name = "view",
      .summary = "View and edit a scene in an interactive window.",
      .examples =
          {
              {"relume view scene.glb", "drag to orbit or look around, WASD to fly; F1 lists the keys"},
              {"relume view city --target 15", "scale the resolution to render 15 frames per second"},
              {"relume view cornell --width 640 --height 480", "an image of fixed size"},
              {"relume view cornell --smoke 10 --screenshot window.png", "no window; for tests"},
          },
      .arguments = {{"SCENE", &options->scene, scene_format_names() + " file, or a built-in scene (default: cornell)",
                     false, Completion::scene}},
      .options = declare(*options),
      .setting_groups = setting_groups(*defaults),
      .setting_flags = &options->flags,
      .run = [options, defaults, &verbosity] { return run(*options, verbosity); },
      .folders = {kBookmarkFolder},
      .essentials = {"width", "height", "target", "camera", "env", "exposure", "denoise", "preset", "settings",
                     "watch"},
  };
  for (Option& option : verbosity_options(verbosity)) command.options.push_back(std::move(option));
  return command;
}

}  // namespace relume::cli
