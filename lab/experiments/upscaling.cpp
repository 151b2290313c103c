// Temporal upscaling: a quarter of the paths, while the camera turns and while it walks.
#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
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
constexpr const char* kThreshold = "ratio at most 1.1";
constexpr float kFlightPace = 10;  // between the towers of `city`

MovingContender contender(const ExperimentScene& scene, std::string name, int upscale) {
  MovingContender result{.name = std::move(name), .settings = scene.settings};
  settings_from_json(describe(result.settings), require_preset("interactive").json, result.name);
  result.settings.upscaling.factor = upscale;
  return result;
}

struct Place {
  ExperimentScene scene;
  int reference_spp = 512;
  std::string reference = {};  ///< settings of references, see MovingOptions
  float pace = 1;              ///< of the walk, as a multiple of kWalkStep_m
};

/// In `warehouse`, the light tree leaves 16 times the noise of `vlc`. A reference with the light tree would be as noisy
/// as the images compared with it.
std::vector<Place> places(const ExperimentContext& context) {
  std::vector<Place> list{{learning_scene("warehouse"), 1024, "lights:vlc"}};
  if (std::optional<ExperimentScene> hall = sponza(context)) list.push_back({std::move(*hall)});
  if (context.quick) {
    for (Place& place : list) place.reference_spp = 16;
  } else {
    list.push_back({.scene = city_street(), .pace = kFlightPace});
  }
  return list;
}

enum class Motion { turn, walk };

const char* name_of(Motion motion) { return motion == Motion::walk ? "walking" : "turning"; }

std::string claim_id(Motion motion, std::string_view scene) {
  std::string id = fmt::format("flip-{}{}", motion == Motion::walk ? "walk-" : "", scene);
  std::transform(id.begin(), id.end(), id.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return id;
}

std::string claim_text(Motion motion, std::string_view scene) {
  return fmt::format("{}, {}: with a quarter of the paths, FLIP is at most 1.1 times that with a path in every pixel.",
                     scene, name_of(motion));
}

Claim claim_flip(Motion motion, const MovingErrors& scene) {
  const MovingError& full = scene.contenders.front();
  const MovingError& upscaled = scene.contenders.back();
  const Ratio flip = paired_error_ratio(upscaled.flips, full.flips);
  return judged_within(
      claim_id(motion, scene.scene), kOurs, claim_text(motion, scene.scene),
      fmt::format("{} of the FLIP ({:.3f}) and {} of the MSE, in {:.0f} % of the time", share_text(flip), full.flip,
                  share_text(paired_error_ratio(upscaled.mses, full.mses)), 100 * upscaled.time_share),
      kThreshold, {flip}, 0, kMostFlip);
}

ImageSet images(Motion motion, const MovingErrors& scene) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < scene.contenders.size(); ++i) {
    const MovingError& e = scene.contenders[i];
    images.push_back({e.name, static_cast<int>(i), &e.last, fmt::format("mean FLIP {:.3f}", e.flip)});
  }
  return measured_set(fmt::format("{}, {}", scene.scene, name_of(motion)), scene.reference, images, {.values = false});
}

MovingErrors measure(const ExperimentContext& context, Motion motion, const Place& place, MovingOptions options) {
  ExperimentScene scene = place.scene;
  options.reference_spp = place.reference_spp;
  options.reference = place.reference;
  if (motion == Motion::walk) {
    options.step_m = kWalkStep_m * place.pace * static_cast<float>(options.frames);
    options.step_deg = kWalkTurn_deg * static_cast<float>(options.frames);
    scene.camera = turned_ahead(place.scene, 0, options.step_m);  // so that the walk begins at the scene's own view
  }
  return measure_moving(context, scene, {contender(scene, "interactive", 1), contender(scene, "upscaled", 2)}, options);
}

/// Share of the references' noise in the lower MSE of the two contenders, before the noise is subtracted. FLIP includes
/// this noise.
std::string noise_text(Motion motion, const MovingErrors& scene) {
  double least = scene.contenders.front().mse;
  for (const MovingError& e : scene.contenders) least = std::min(least, e.mse);
  return fmt::format("{}, {}: {:.1f} %", scene.scene, name_of(motion),
                     100 * scene.reference_mse / (std::max(least, 0.0) + scene.reference_mse));
}

std::string reference_text(const std::vector<Place>& list) {
  std::string text;
  for (const Place& place : list)
    text += fmt::format("{}{} in {}", text.empty() ? "" : ", ", place.reference_spp, place.scene.name);
  return text + " samples per pixel by path tracing with the light tree, in `warehouse` with `vlc`";
}

ExperimentResult run_upscaling(const ExperimentContext& context) {
  const std::vector<Place> list = places(context);
  const MovingOptions options{
      .frames = context.choose(12, 3), .equal_frames = true, .repetitions = context.choose(6, 2)};
  ExperimentResult result;
  std::vector<ImageSet> sets;
  std::string noise;
  for (const Motion motion : {Motion::turn, Motion::walk}) {
    for (const Place& place : list) {
      ExperimentContext part = context;
      part.progress = [&, number = sets.size() + 1](const std::string& stage, double fraction) {
        context.report(fmt::format("{} of {}: {}, {}", number, 2 * list.size(), stage, name_of(motion)), fraction);
      };
      const MovingErrors errors = measure(part, motion, place, options);
      result.claims.push_back(claim_flip(motion, errors));
      sets.push_back(images(motion, errors));
      noise += (noise.empty() ? "" : "; ") + noise_text(motion, errors);
    }
    if (context.scene_folder.empty()) {
      result.claims.push_back(
          unmeasured(claim_id(motion, "Sponza"), kOurs, claim_text(motion, "Sponza"), kThreshold, kNoSponza));
    }
  }
  result.blocks.emplace_back(ViewerBlock{"Images", "Displayed image at the last view, while the camera moves.",
                                         image_layer_kinds(), std::move(sets)});
  result.setup = {
      {"Camera",
       fmt::format("turns by 10° from view to view, in {} frames, or walks: per frame it moves ahead by 5 cm and turns "
                   "by 0.5° (`city`: 50 cm); two views are measured, in each of {} repetitions",
                   options.frames, options.repetitions)},
      {"Techniques", "preset `interactive`, with `--upscale` 1 and 2; equal numbers of frames"},
      {"Size", size_text(context)},
      {"Reference", reference_text(list)},
      {"Noise of references", noise + " of the lower MSE. The noise is subtracted from MSE, not from FLIP"}};
  return result;
}

}  // namespace

Experiment upscaling_experiment() {
  return {"upscaling", kOurs, "temporal upscaling against a path in every pixel, while the camera turns and walks",
          run_upscaling};
}

}  // namespace relume
