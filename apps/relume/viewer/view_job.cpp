#include "viewer/view_job.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <future>

#include "console.h"
#include "core/clock.h"
#include "picture.h"
#include "platform.h"
#include "render/settings.h"
#include "scene_source.h"
#include "viewer/app.h"
#include "viewer/start_settings.h"

namespace relume::cli {

int run_view(const ViewOptions& options, const Verbosity& verbosity) {
  SettingSources sources{.preset = options.preset, .file = options.settings_file, .flags = options.flags};
  resolve(sources);  // finds what is wrong with them before anything is loaded
  if (!options.screenshot.empty()) check_picture_file(options.screenshot, {});
  const double start_s = now_s();
  // On a thread of low priority, whose children rendering uses later: the interface keeps the right of way.
  auto loading = std::async(std::launch::async, [&] {
    lower_thread_priority();
    return open_scene(options.scene);
  });
  Scene scene = loading.get();
  sources.scene_json = scene.settings_json;
  sources.scene_place = options.scene;
  const Settings settings = viewer::resolve_start(sources);
  const double load_s = now_s() - start_s;
  warn_all(verbosity, scene.warnings);
  const bool fixed_size = std::any_of(options.flags.begin(), options.flags.end(),
                                      [](const auto& flag) { return flag.first == "width" || flag.first == "height"; });
  viewer::LoadedScene loaded{options.scene, std::move(scene), load_s};
  viewer::App app(options, settings, fixed_size, std::make_shared<const viewer::LoadedScene>(std::move(loaded)));
  app.run();
  if (app.loading()) {
    // Nobody waits for a scene that nobody will see.
    std::fflush(nullptr);
    std::_Exit(kExitDone);
  }
  return kExitDone;
}

}  // namespace relume::cli
