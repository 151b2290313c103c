#include <memory>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "render/settings.h"
#include "serve/serve_job.h"

namespace relume::cli {
namespace {

std::vector<Option> declare(ServeOptions& o) {
  std::vector<Option> options = {
      {{"bind", &o.bind,
        "Numeric address to listen on. Only loopback addresses are safe without a proxy that adds TLS"},
       "ADDRESS"},
      {{"port", &o.port, "TCP port; 0: any free one", {.min = 0, .max = 65535}}},
      {{"host", &o.hosts, "Further name by which browsers reach the server, such as that of a proxy; may be repeated"},
       "NAME",
       0,
       Completion::none,
       true},
      {{"viewers", &o.viewers, "Browsers that may watch at the same time; one of them steers", {.min = 1, .max = 64}}},
  };
  for (Option& option : viewer_options(o,
                                       "Show the image through a view of an OpenColorIO configuration. It replaces the "
                                       "tone map of scene, --preset and --settings"))
    options.push_back(std::move(option));
  return options;
}

int run([[maybe_unused]] const ServeOptions& options, [[maybe_unused]] const Verbosity& verbosity) {
#if defined(RELUME_HAS_SERVE)
  return run_serve(options, verbosity);
#else
  throw Error(
      "this relume was built without its server; install libboost-dev and libturbojpeg0-dev, then configure and build "
      "again (scripts/build does both)");
#endif
}

}  // namespace

Command serve_command(Verbosity& verbosity) {
  // Both live as long as the command.
  const auto options = std::make_shared<ServeOptions>();
  const auto defaults = std::make_shared<AllSettings>();
  Command command = viewer_command(*options, *defaults, declare(*options), verbosity);
  command.name = "serve";
  command.summary = "View a scene in a browser, for machines without a screen.";
  command.examples = {
      {"relume serve scene.glb", "open the printed address; it contains the token that viewers need"},
      {"relume serve city --target 15", "scale the resolution to render 15 frames per second"},
      {"relume serve cornell --port 0 --width 640 --height 360", "any free port, an image of fixed size"},
  };
  command.run = [options, defaults, &verbosity] { return run(*options, verbosity); };
  command.essentials = {"bind",   "port", "host",     "viewers", "width",  "height",   "target",
                        "camera", "env",  "exposure", "denoise", "preset", "settings", "watch"};
  return command;
}

}  // namespace relume::cli
