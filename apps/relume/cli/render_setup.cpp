#include "cli/render_setup.h"

#include <utility>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/image.h"
#include "cli/preparation_progress.h"
#include "cli/scene_source.h"
#include "core/clock.h"
#include "frame/launch.h"
#include "render/build_pipeline.h"

namespace relume::cli {
namespace {

/// The window of --crop, or else the part that the scene's file requests, if the techniques allow it.
PixelWindow choose_window(const RenderOptions& options, const Verbosity& verbosity, const RenderSetup& setup,
                          const Scene& scene) {
  if (!setup.plan.crop.empty()) return setup.plan.crop;
  RenderSettings cropped = setup.settings.render;
  cropped.crop = pixels_of(scene.crop, cropped.width, cropped.height);
  const PixelWindow& w = cropped.crop;
  if (w.empty() || !refusal(setup.settings.render).empty()) return {};
  const std::string request =
      fmt::format("{} requests the crop {},{},{},{}", options.scene, w.x, w.y, w.width, w.height);
  if (const std::string conflict = refusal(cropped); !conflict.empty()) {
    log_info(verbosity, fmt::format("{}, but the whole image is rendered: {}", request, conflict));
    return {};
  }
  log_info(verbosity,
           fmt::format("{}; --crop 0,0,{},{} renders the whole image", request, cropped.width, cropped.height));
  return w;
}

void build(RenderSetup& setup, Scene scene, const Verbosity& verbosity) {
  const PreparationProgress progress(!verbosity.quiet);
  setup.session.emplace(std::move(scene), setup.settings.render);
}

}  // namespace

float time_of_image(const RenderOptions& options, const RenderPlan& plan, float scene_time_s, size_t index) {
  if (options.frames.empty()) return scene_time_s;
  return frame_time_s(plan.frames.first + static_cast<int>(index), options.fps, scene_time_s);
}

RenderSetup set_up_render(const RenderOptions& options, const Verbosity& verbosity, RenderPlan plan, int threads) {
  RenderSetup setup;
  setup.plan = std::move(plan);
  const double start_s = now_s();
  const ThreadLimit limit(setup.plan.threads > 0 ? setup.plan.threads : threads);
  Scene scene = open_scene(options.scene, !verbosity.quiet);
  setup.plan.sources.scene_json = scene.settings_json;
  setup.plan.sources.scene_place = options.scene;
  AllSettings& settings = setup.settings;
  settings = resolve(setup.plan.sources);
  check_stop_settings(settings);
  if (settings.render.threads == 0) settings.render.threads = threads;
  setup.plan.aovs = wanted_aovs(options, settings.render);
  setup.plan.roles.reads("--env", settings.scene.env);
  setup.plan.roles.reads("SCENE", scene.source_files);
  override_scene(settings.scene, scene, !verbosity.quiet);
  fit_to_camera(settings, setup.plan.sources, scene);
  warn_all(verbosity, scene);
  setup.load_s = now_s() - start_s;
  tell_more(verbosity, fmt::format("loaded {} in {:.2f} s", options.scene, setup.load_s));

  setup.scene_time_s = settings.render.time_s;
  const auto time_of = [&](size_t index) { return time_of_image(options, setup.plan, setup.scene_time_s, index); };
  settings.render.time_s = time_of(0);
  time_of(setup.plan.files.size() - 1);  // fails before rendering
  plan_samples(setup.plan, settings);
  settings.render.crop = choose_window(options, verbosity, setup, scene);
  build(setup, std::move(scene), verbosity);
  for (const std::string& note : setup.session->notes()) log_info(verbosity, note);
  if (setup.plan.ocio && !setup.plan.ocio->note().empty()) log_info(verbosity, setup.plan.ocio->note());
  return setup;
}

}  // namespace relume::cli
