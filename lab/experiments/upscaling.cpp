// Temporal upscaling: a quarter of the paths, while the camera turns.
#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/moving_error.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "render/presets.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr double kMostFlip = 1.1;

MovingContender contender(const ExperimentScene& scene, std::string name, int upscale) {
  MovingContender result{.name = std::move(name), .settings = scene.settings};
  settings_from_json(describe(result.settings), require_preset("interactive").json, result.name);
  result.settings.upscaling.factor = upscale;
  return result;
}

Claim claim_flip(const MovingErrors& scene) {
  const MovingError& full = scene.contenders.front();
  const MovingError& upscaled = scene.contenders.back();
  const Ratio flip = paired_error_ratio(upscaled.flips, full.flips);
  std::string id = "flip-" + scene.scene;
  std::transform(id.begin(), id.end(), id.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return judged_within(
      id, kOurs,
      scene.scene + ": with a quarter of the paths, FLIP is at most 1.1 times that with a path in every pixel.",
      fmt::format("{} of the FLIP ({:.3f}) and {} of the MSE, in {:.0f} % of the time", share_text(flip), full.flip,
                  share_text(paired_error_ratio(upscaled.mses, full.mses)), 100 * upscaled.time_share),
      "ratio at most 1.1", {flip}, 0, kMostFlip);
}

ImageSet images(const MovingErrors& scene) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < scene.contenders.size(); ++i) {
    const MovingError& e = scene.contenders[i];
    images.push_back({e.name, static_cast<int>(i), &e.last, fmt::format("mean FLIP {:.3f}", e.flip)});
  }
  return measured_set(scene.scene, scene.reference, images, {.values = false});
}

ExperimentResult run_upscaling(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{learning_scene("warehouse")};
  if (std::optional<ExperimentScene> hall = sponza(context)) list.push_back(std::move(*hall));
  if (!context.quick) list.push_back(city_street());
  const MovingOptions options{.frames = context.choose(12, 3),
                              .equal_frames = true,
                              .repetitions = context.choose(6, 2),
                              .reference_spp = context.choose(1024, 16)};
  ExperimentResult result;
  std::vector<ImageSet> sets;
  for (const ExperimentScene& scene : list) {
    const MovingErrors errors =
        measure_moving(context, scene, {contender(scene, "interactive", 1), contender(scene, "upscaled", 2)}, options);
    result.claims.push_back(claim_flip(errors));
    sets.push_back(images(errors));
  }
  if (context.scene_folder.empty()) {
    result.claims.push_back(
        unmeasured("flip-sponza", kOurs,
                   "Sponza: with a quarter of the paths, FLIP is at most 1.1 times that with a path "
                   "in every pixel.",
                   "ratio at most 1.1", kNoSponza));
  }
  result.blocks.emplace_back(ViewerBlock{"Images", "Displayed image at the last view, while the camera turns.",
                                         image_layer_kinds(), std::move(sets)});
  result.setup = {
      {"Camera", fmt::format("turns by 10° from view to view, in {} frames; two views are measured, in each of {} "
                             "repetitions",
                             options.frames, options.repetitions)},
      {"Techniques", "preset `interactive`, with `--upscale` 1 and 2; equal numbers of frames"},
      {"Size", size_text(context)},
      {"Reference", fmt::format("{} samples per pixel by path tracing with the light tree", options.reference_spp)}};
  return result;
}

}  // namespace

Experiment upscaling_experiment() {
  return {"upscaling", kOurs, "temporal upscaling against a path in every pixel, while the camera turns",
          run_upscaling};
}

}  // namespace relume
