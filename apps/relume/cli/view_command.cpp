#include <memory>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "render/settings.h"
#include "viewer/view_job.h"

namespace relume::cli {
namespace {

std::vector<Option> declare(ViewOptions& o) {
  std::vector<Option> options = viewer_options(o,
                                               "Show the image, and write PNG, through a view of an OpenColorIO "
                                               "configuration. It replaces the tone map of scene, --preset and "
                                               "--settings");
  std::vector<Option> own = {
      {{"smoke", &o.smoke, "Render this many frames without a window, print a report as JSON and exit", {.min = 0}}},
      {{"screenshot", &o.screenshot, "Write an image of the window before exiting"}, "FILE", 0, Completion::file},
      {{"script", &o.script, "Steps to perform: keys, mouse, settings (docs/viewer.md)"}, "FILE", 0, Completion::file},
  };
  for (Option& option : own) options.push_back(std::move(option));
  return options;
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
  Command command = viewer_command(*options, *defaults, declare(*options), verbosity);
  command.name = "view";
  command.summary = "View and edit a scene in an interactive window.";
  command.examples = {
      {"relume view scene.glb", "drag to orbit or look around, WASD to fly; F1 lists the keys"},
      {"relume view city --target 15", "scale the resolution to render 15 frames per second"},
      {"relume view cornell --width 640 --height 480", "an image of fixed size"},
      {"relume view cornell --smoke 10 --screenshot window.png", "no window; for tests"},
  };
  command.run = [options, defaults, &verbosity] { return run(*options, verbosity); };
  command.essentials = {"width",    "height",  "target", "camera",   "env",
                        "exposure", "denoise", "preset", "settings", "watch"};
  return command;
}

}  // namespace relume::cli
