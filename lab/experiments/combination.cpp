// [Schalk18 §4.4]: adaptive sampling combined with reprojection, after a turn in steps of five degrees.
#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schalk18 §4.4]";

struct SceneResult {
  std::string name;
  std::vector<Trace> traces;  ///< restarted accumulation, reprojection, combinations
  ImageSet images;
};

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, std::string name,
                         int samples_per_step, int min_samples) {
  TraceContender result{.name = std::move(name), .settings = scene.settings, .samples_per_step = samples_per_step};
  set_size_and_device(context, result.settings);
  if (samples_per_step > 0) {
    result.settings.history = HistoryChoice::reproject;
    result.settings.reproject.stored = StoredSampleChoice::one;
    result.settings.reproject.fill = false;  // not part of the paper
  }
  if (min_samples > 0) {
    result.settings.allocation = AllocationChoice::adaptive;
    result.settings.adaptive.method = AdaptiveMethod::paper;
    result.settings.adaptive.min_samples = min_samples;
    result.settings.adaptive.max_samples = 32;
    result.map = "sampling-probability";
  }
  return result;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, scene);
  const int samples = context.quick ? 8 : 64;
  const std::vector<TraceContender> contenders{contender(context, scene, "restart", 0, 0),
                                               contender(context, scene, "reprojection", samples, 0),
                                               contender(context, scene, "combination, min/max 4/32", samples, 4),
                                               contender(context, scene, "combination, min/max 2/32", samples, 2)};
  const TraceOptions options{.turn = {100, context.quick ? 20.0f : 5.0f},
                             .frames = context.quick ? 24u : 96u,
                             .repetitions = context.choose(3, 1),
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .image_frame = 8};
  std::vector<Trace> traces = trace(context, scene.name, scene, contenders, options);
  ImageSet images = trace_images(scene.name, traces, reference.image);
  return {scene.name, std::move(traces), std::move(images)};
}

void claim_box(const SceneResult& scene, std::vector<Claim>& claims) {
  const Ratio ratio = early_ratio(scene.traces, 2, 1, 32);
  claims.push_back(judged_within(
      "box-loses", kPaper, "On the box the combination is not better than reprojection alone (discussion: worse).",
      share_text(ratio) + " of the MSE of reprojection (4/32, first 32 frames)", "ratio at least 1", {ratio}, 1));
  const Ratio restarted = early_ratio(scene.traces, 2, 0, 8);
  claims.push_back(judged_within("box-beats-path", kPaper,
                                 "On the box the combination is better than path tracing in the first frames.",
                                 share_text(restarted) + " of the MSE of restarted accumulation (first 8 frames)",
                                 "ratio at most 1", {restarted}, 0, 1));
}

void claim_sponza(const SceneResult* scene, std::vector<Claim>& claims) {
  constexpr double kPaperFrames = 27;  // 700 ms in the paper, at 26 ms per frame
  const std::string wins =
      "On Sponza the combination is better than reprojection for the first 700 ms, about 27 frames.";
  const std::string order = "On Sponza min/max 4/32 is better than 2/32.";
  const std::string threshold = "ratio at most 1";
  if (!scene) {
    claims.push_back(unmeasured("sponza-wins", kPaper, wins, threshold, kNoSponza));
    claims.push_back(unmeasured("sponza-minimum", kPaper, order, threshold, kNoSponza));
    return;
  }
  const Ratio ratio = early_ratio(scene->traces, 2, 1, kPaperFrames);
  claims.push_back(judged_within("sponza-wins", kPaper, wins, share_text(ratio) + " of the MSE of reprojection (4/32)",
                                 threshold, {ratio}, 0, 1));
  const Ratio minimum = early_ratio(scene->traces, 2, 3, kPaperFrames);
  claims.push_back(judged_within("sponza-minimum", kPaper, order, share_text(minimum) + " of the MSE of 2/32",
                                 threshold, {minimum}, 0, 1));
}

ExperimentResult run_combination(const ExperimentContext& context) {
  std::vector<SceneResult> results;
  results.push_back(measure(context, closed_box()));
  const std::optional<ExperimentScene> hall = sponza(context);
  if (hall) results.push_back(measure(context, *hall));
  if (!context.quick) results.push_back(measure(context, city_street()));
  ExperimentResult result;
  claim_box(results.front(), result.claims);
  claim_sponza(hall ? &results[1] : nullptr, result.claims);
  std::vector<ImageSet> images;
  for (SceneResult& scene : results) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(trace_viewer("Images",
                                          "After the last step, at the time of eight frames of restarted accumulation. "
                                          "Maps: final probability of a sample.",
                                          std::move(images)));
  for (const SceneResult& scene : results) {
    result.blocks.emplace_back(trace_charts(scene.name, "Error after the last step of a turn of 100°.", scene.traces,
                                            &TracePoint::mse, "MSE"));
  }
  result.setup = common_setup(context);
  result.setup.insert(result.setup.end(),
                      {{"Turn", context.quick ? "100° in steps of 20°, 8 samples per step, one stored"
                                              : "100° in steps of 5°, 64 samples per step, one stored"},
                       {"Repetitions", "three sequences (one in a quick run); contenders take turns frame by frame"}});
  return result;
}

}  // namespace

Experiment combination_experiment() {
  return {"combination", kPaper, "adaptive sampling with reprojection", run_combination};
}

}  // namespace relume
