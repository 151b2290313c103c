#include <memory>

#include "command.h"
#include "render/settings.h"
#include "scene_io/scene_format.h"
#include "viewer/view_job.h"

namespace relume::cli {
namespace {

std::vector<Option> declare(ViewOptions& o) {
  return {
      {{"preset", &o.preset, "Named settings; flags override them; 'interactive' where no technique is chosen"},
       "NAME",
       0,
       Completion::preset},
      {{"settings", &o.settings_file, "Settings as JSON, or those that an EXR was rendered with"},
       "FILE",
       0,
       Completion::file},
      {{"ocio", &o.ocio,
        "Show the image, and write PNG, through a view of an OpenColorIO configuration in place of the tone map, "
        "whatever the scene, --preset or --settings choose"},
       "CONFIG:VIEW",
       0,
       Completion::file},
      {{"target", &o.target_hz, "Rendered frames a second to hold by scaling the resolution", {.min = 1, .max = 240}}},
      {{"watch", &o.watch, "Read the scene again when its files change, with the same camera and settings"}},
      {{"smoke", &o.smoke, "Show no window, render this many frames, print a report as JSON and end", {.min = 0}}},
      {{"screenshot", &o.screenshot, "Write an image of the window before ending"}, "FILE", 0, Completion::file},
      {{"script", &o.script, "Steps to go through: keys, mouse, settings (docs/viewer.md)"},
       "FILE",
       0,
       Completion::file},
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
  // Both live as long as the command that refers to them.
  const auto options = std::make_shared<ViewOptions>();
  const auto defaults = std::make_shared<AllSettings>();
  Command command{
      .name = "view",
      .summary = "Explore a scene in a window; change everything while it renders.",
      .examples =
          {
              {"relume view scene.glb", "drag goes around or looks around, WASD flies; F1 lists the keys"},
              {"relume view city --target 15", "scale the resolution so that 15 frames a second are rendered"},
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
