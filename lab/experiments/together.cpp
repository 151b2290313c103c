// Learned light selection and guiding together with radiance caches and bidirectional path tracing, against each alone.
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "experiments/setup/apply_settings.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "metrics/statistics.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr int kFirstFrames = 8;
constexpr double kLeastGain = 2;  ///< error of sampling by power over that of the light cache, both with psf
constexpr int kBounces = 8;
constexpr double kEqualTime_s = 2;

/// Errors of the displayed image in the first frames after a start.
Adaptation first_frames(const ExperimentContext& context, const ExperimentScene& scene, const std::string& name,
                        const std::string& texts, const Reference& reference, const PixelMask& surfaces) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  apply_settings(texts, "together", settings);
  Session session(Scene(scene.scene), settings);
  session.set_camera(scene.camera);
  return measure_adaptation(context, name, session, context.choose(64, 2), kFirstFrames, reference, surfaces);
}

/// Mean over all frames, by runs.
std::vector<double> means_of_runs(const Adaptation& adaptation) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs) means.push_back(mean(run));
  return means;
}

void measure_warehouse(const ExperimentContext& context, ExperimentResult& result) {
  const ExperimentScene scene = learning_scene("warehouse");
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  const std::vector<Adaptation> list = {
      first_frames(context, scene, "psf+power", "cache:psf,lights:power", reference, surfaces),
      first_frames(context, scene, "psf+vlc", "cache:psf,lights:vlc", reference, surfaces),
      first_frames(context, scene, "vlc", "lights:vlc", reference, surfaces)};
  const Ratio gain = error_ratio(means_of_runs(list[0]), means_of_runs(list[1]));
  const Ratio alone = error_ratio(means_of_runs(list[2]), means_of_runs(list[1]));
  result.claims.push_back(
      judged_ratios("warehouse-first-frames", kOurs,
                    "warehouse: in the first eight frames, path space filtering with the light cache has at most half "
                    "of the error that it has with sampling by power.",
                    fmt::format("with sampling by power {} the MSE, the light cache without the filter {}",
                                to_text(gain), to_text(alone)),
                    {gain}, kLeastGain));
  result.blocks.emplace_back(adaptation_chart(
      "Warehouse", "Error of the displayed image after a start. Bands are 95 % intervals of the mean over the runs.",
      list, 1));
}

/// A combination against its parts, at equal time.
struct Pair {
  const char* id;
  const char* scene;
  const char* claim;
  const char* both;                ///< settings of the combination
  std::vector<const char*> alone;  ///< names of the parts, which are contenders of `techniques`
  const char* techniques;          ///< the combination is called "both"
  SettingTexts reference;
  int reference_spp;
  Rectangle region = {"image"};  ///< of the error
};

void measure_pair(const ExperimentContext& context, const Pair& pair, ExperimentResult& result) {
  const StudyOptions options{.techniques = fmt::format("{},both={}", pair.techniques, pair.both),
                             .reference = pair.reference,
                             .budget_s = kEqualTime_s,
                             .repetitions = 6,
                             .reference_spp = pair.reference_spp};
  const Comparison comparison = study(context, at_rest(built_in(pair.scene, kBounces)), options);
  std::string measured;
  std::vector<Ratio> ratios;
  for (const char* name : pair.alone) {
    ratios.push_back(region_ratio(comparison, name, "both", pair.region));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", name, to_text(ratios.back()));
  }
  result.claims.push_back(
      judged_ratios(pair.id, kOurs, fmt::format("{}: {}", pair.scene, pair.claim), measured + " the MSE", ratios, 1));
  for (Block& block : study_blocks(fmt::format("{}, equal time", pair.scene), comparison))
    result.blocks.push_back(std::move(block));
}

/// Quadtrees of importance for light subpaths, against unguided subpaths and guided camera subpaths.
void measure_guided_light_subpaths(const ExperimentContext& context, ExperimentResult& result) {
  constexpr const char* kClaim =
      "at equal time, guided subpaths from both ends have less error than unguided ones and than guided camera "
      "subpaths.";
  for (const auto& [id, scene] :
       {std::pair("corridor-guided-light-subpaths", "corridor"), std::pair("door-guided-light-subpaths", "door")}) {
    measure_pair(context,
                 {id,
                  scene,
                  kClaim,
                  "estimator:bdpt,guide:cdq,cdq.importance:on,octree.vertices:4",
                  {"bdpt", "guided"},
                  "bdpt=estimator:bdpt,guided=estimator:bdpt,guide:cdq,octree.vertices:4",
                  {{"estimator", "bdpt"}},
                  512},
                 result);
  }
  measure_pair(context,
               {"water-guided-light-subpaths",
                "cornell-water",
                kClaim,
                "estimator:vcm,guide:cdq,cdq.importance:on,octree.vertices:4",
                {"vcm", "guided"},
                "vcm=estimator:vcm,guided=estimator:vcm,guide:cdq,octree.vertices:4",
                {{"estimator", "vcm"}, {"vcm.radius", "0.002"}, {"vcm.alpha", "0.75"}},
                384,
                {"below the water", 0.05, 0.78, 0.95, 0.96}},
               result);
}

ExperimentResult run_together(const ExperimentContext& context) {
  ExperimentResult result;
  measure_warehouse(context, result);
  measure_pair(context,
               {"corridor-guided-graphs",
                "corridor",
                "at equal time, path graphs with guided directions have less error than each alone.",
                "cache:apg,guide:cdq",
                {"apg", "cdq"},
                "apg=cache:apg,cdq=guide:cdq",
                {{"guide", "cdq"}},
                1024},
               result);
  measure_pair(context,
               {"lamp-room-cached-lights",
                "lamp-room",
                "at equal time, bidirectional path tracing has less error with the light cache than without it.",
                "estimator:bdpt,lights:vlc",
                {"bdpt"},
                "bdpt=estimator:bdpt",
                {{"estimator", "bdpt"}},
                512},
               result);
  measure_guided_light_subpaths(context, result);
  result.setup = {{"Size", size_text(context)},
                  {"Warehouse", fmt::format("{} seeds, two bounces, error without edges of lamps; reference of {} "
                                            "samples with the light tree",
                                            context.choose(64, 2), learning_reference_spp(context))},
                  {"Corridor", "8 bounces; reference of 1024 samples with guided directions"},
                  {"Lamp room", "8 bounces; reference of 512 samples of bdpt"},
                  {"Guided light subpaths",
                   "8 bounces; references of 512 samples of bdpt, and of 384 samples of vcm "
                   "with radius 0.002 and alpha 0.75; quadtrees learn from four vertices"},
                  {"Equal time", context.quick ? "0.05 s" : "2 s"}};
  return result;
}

}  // namespace

Experiment together_experiment() {
  return {"together", kOurs, "learning with radiance caches and bidirectional path tracing, against each alone",
          run_together};
}

}  // namespace relume
