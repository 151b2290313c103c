// Sampling in proportion to the standard deviation ([Neyman34], §4), estimated from neighbouring pixels: compared with
// uniform sample counts and the method of [Schalk18].
#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "builtin_scenes/builtin.h"
#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";

constexpr const char* kPathTracing = "path tracing";
constexpr const char* kIndependent = "independent samples";
constexpr const char* kPooled = "pooled";
constexpr const char* kPooledDisplay = "pooled, display";
constexpr const char* kPaper = "paper";
constexpr const char* kPaperIndependent = "paper, independent";

/// Time range of comparisons in frames of path tracing, starting after every pixel's first samples.
constexpr double kBegin = 8;
constexpr double kEnd = 64;

struct SceneResult {
  std::string name;
  std::vector<Trace> traces;  ///< path tracing first
  ImageSet images;
};

int method_reference_spp(const ExperimentContext& context) { return context.choose(1024, 16); }
int built_in_reference_spp(const ExperimentContext& context) { return context.choose(512, 16); }

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, const char* name) {
  TraceContender result{.name = name, .settings = scene.settings};
  set_size_and_device(context, result.settings, scene.scale);
  return result;
}

TraceContender adaptive(const ExperimentContext& context, const ExperimentScene& scene, const char* name,
                        AdaptiveMethod method, AdaptiveMetric metric = AdaptiveMetric::linear) {
  TraceContender result = contender(context, scene, name);
  result.settings.allocation = AllocationChoice::adaptive;
  result.settings.adaptive.method = method;
  result.settings.adaptive.metric = metric;
  result.map = "sampling-probability";
  return result;
}

/// Uses independent random numbers for every sample, as in the paper.
TraceContender independent(TraceContender contender) {
  contender.settings.stratify = false;
  return contender;
}

std::vector<TraceContender> all_contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  return {contender(context, scene, kPathTracing),
          independent(contender(context, scene, kIndependent)),
          adaptive(context, scene, kPooled, AdaptiveMethod::pooled),
          adaptive(context, scene, kPooledDisplay, AdaptiveMethod::pooled, AdaptiveMetric::display),
          adaptive(context, scene, kPaper, AdaptiveMethod::paper),
          independent(adaptive(context, scene, kPaperIndependent, AdaptiveMethod::paper))};
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene,
                    const std::vector<TraceContender>& contenders, int reference_spp, int repetitions) {
  const Reference reference = make_reference(context, scene, reference_spp);
  const TraceOptions options{.turn = {},
                             .frames = static_cast<uint32_t>(kEnd),
                             .repetitions = context.choose(repetitions, 1),
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .image_frame = 32};
  std::vector<Trace> traces = trace(context, scene.name, scene, contenders, options);
  ImageSet images = trace_images(scene.name, traces, reference.image);
  return {scene.name, std::move(traces), std::move(images)};
}

/// Sponza and the box, with every method.
std::vector<SceneResult> measure_methods(const ExperimentContext& context) {
  std::vector<ExperimentScene> scenes{closed_box()};
  if (std::optional<ExperimentScene> hall = sponza(context)) scenes.push_back(std::move(*hall));
  std::vector<SceneResult> results;
  for (ExperimentScene& scene : scenes) {
    scene.scale = 3;
    results.push_back(measure(context, scene, all_contenders(context, scene), method_reference_spp(context), 5));
  }
  return results;
}

/// Built-in scenes with the default method: all in a full run.
std::vector<SceneResult> measure_built_in(const ExperimentContext& context) {
  const std::set<std::string_view> quick{"cornell-glass", "mine"};
  std::vector<SceneResult> results;
  for (const BuiltinScene& builtin : builtin_scenes()) {
    if (context.quick && !quick.contains(builtin.name)) continue;
    ExperimentScene scene = at_rest(built_in(builtin.name, RenderSettings{}.path.max_bounces));
    scene.scale = 2;
    results.push_back(
        measure(context, scene,
                {contender(context, scene, kPathTracing), adaptive(context, scene, kPooled, AdaptiveMethod::pooled)},
                built_in_reference_spp(context), 3));
  }
  return results;
}

Ratio ratio(const SceneResult& result, std::string_view name, TraceValue value,
            std::string_view baseline = kPathTracing) {
  const auto index_of = [&](std::string_view wanted) {
    const auto found = std::find_if(result.traces.begin(), result.traces.end(),
                                    [&](const Trace& trace) { return trace.name == wanted; });
    return static_cast<size_t>(found - result.traces.begin());
  };
  return mean_ratio(result.traces, index_of(name), index_of(baseline), value, kBegin, kEnd);
}

TableBlock table(const std::string& title, const std::string& what, const std::vector<SceneResult>& results,
                 TraceValue value) {
  TableBlock block{title,
                   fmt::format("{} over that of path tracing at equal time, mean over the times of {} to {} frames of "
                               "path tracing; below 1 is better.",
                               what, kBegin, kEnd),
                   "scene",
                   {},
                   {}};
  for (size_t i = 1; i < results.front().traces.size(); ++i) block.columns.push_back({results.front().traces[i].name});
  for (const SceneResult& result : results) {
    TableRow row{.name = result.name, .cells = {}};
    for (const TableColumn& column : block.columns) {
      const Ratio share = ratio(result, column.title, value);
      row.cells.push_back({share_text(share), share.value});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

Claim claim_gain(const SceneResult& result, std::string id, const char* place, double most) {
  const Ratio mse = ratio(result, kPooled, &TracePoint::mse);
  return judged_within(
      std::move(id), kOurs,
      fmt::format("In {} sampling in proportion to the standard deviation has the lower MSE at equal time.", place),
      fmt::format("{} of path tracing's MSE, {} of that with independent samples; of display values {}",
                  share_text(mse), share_text(ratio(result, kPooled, &TracePoint::mse, kIndependent)),
                  share_text(ratio(result, kPooledDisplay, &TracePoint::display_mse))),
      fmt::format("at most {} of path tracing's", most), {mse}, 0, most);
}

Claim claim_never_worse(const std::vector<SceneResult>& results) {
  std::vector<Ratio> ratios;
  for (const SceneResult& result : results) ratios.push_back(ratio(result, kPooled, &TracePoint::mse));
  const auto largest =
      std::max_element(ratios.begin(), ratios.end(), [](const Ratio& a, const Ratio& b) { return a.value < b.value; });
  return judged_within("never-worse", kOurs, "In no built-in scene does it have a higher MSE at equal time.",
                       fmt::format("the largest is {}, in {}", share_text(*largest),
                                   results[static_cast<size_t>(largest - ratios.begin())].name),
                       "at most 1.02 of path tracing's in each", ratios, 0, 1.02);
}

ExperimentResult run_proportional_sampling(const ExperimentContext& context) {
  std::vector<SceneResult> methods = measure_methods(context);
  const std::vector<SceneResult> built_in_scenes = measure_built_in(context);
  ExperimentResult result;
  result.claims.push_back(claim_gain(methods.front(), "gain-box", "the closed box", 0.9));
  if (methods.size() > 1) result.claims.push_back(claim_gain(methods.back(), "gain-sponza", "Sponza", 0.65));
  claim_without_sponza(
      context, kOurs,
      {{"gain-sponza", "In Sponza sampling in proportion to the standard deviation has the lower MSE at equal time.",
        "at most 0.65 of path tracing's"}},
      result.claims);
  result.claims.push_back(claim_never_worse(built_in_scenes));
  result.blocks.emplace_back(table("MSE", "MSE", methods, &TracePoint::mse));
  result.blocks.emplace_back(
      table("Display values", "MSE of sRGB values, clamped at 1,", methods, &TracePoint::display_mse));
  result.blocks.emplace_back(table("MSE in built-in scenes", "MSE", built_in_scenes, &TracePoint::mse));
  std::vector<ImageSet> images;
  for (SceneResult& scene : methods) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(trace_viewer(
      "Images", "At the time of 32 frames of path tracing. Maps: final probability of a sample.", std::move(images)));
  for (const SceneResult& scene : methods)
    result.blocks.emplace_back(trace_charts(scene.name, "", scene.traces, &TracePoint::mse, "MSE"));
  result.setup = {{"Size", context.quick ? size_text(context)
                                         : size_text(context) + ", three times along each edge; built-in scenes twice"},
                  {"Reference", fmt::format("{} samples per pixel, built-in scenes {}", method_reference_spp(context),
                                            built_in_reference_spp(context))},
                  {"Measure", "MSE of linear values, and of sRGB values that are clamped at 1"},
                  {"Repetitions",
                   "five sequences, built-in scenes three (one in a quick run); contenders take turns "
                   "frame by frame"}};
  return result;
}

}  // namespace

Experiment proportional_sampling_experiment() {
  return {"proportional-sampling", kOurs, "sampling in proportion to the standard deviation, against other allocations",
          run_proportional_sampling};
}

}  // namespace relume
