// [Schalk18 §4.2]: compares the variance of the distance to the reference with adaptive and with uniform sample counts.
#include <functional>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schalk18 §4.2]";

/// Table 1 of the paper.
struct Bounds {
  int min;
  int max;
};
constexpr Bounds kTable[] = {{2, 16}, {4, 16}, {8, 16}, {2, 32}, {4, 32}, {8, 32}, {16, 32}};

std::string name_of(const Bounds& bounds) { return fmt::format("{}/{}", bounds.min, bounds.max); }

constexpr const char* kPathTracing = "path tracing";
/// Uniform sample counts with independent random numbers, as adaptive sampling uses here. This is the paper's baseline;
/// it also shows the loss against path tracing's low-discrepancy points.
constexpr const char* kIndependent = "independent samples";

struct SceneResult {
  std::string name;
  std::string property;
  std::vector<Trace> traces;  ///< path tracing first
  ImageSet images;
};

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, const Bounds* bounds) {
  TraceContender result{.name = bounds ? "min/max " + name_of(*bounds) : kPathTracing, .settings = scene.settings};
  set_size_and_device(context, result.settings);
  if (!bounds) return result;
  result.settings.allocation = AllocationChoice::adaptive;
  result.settings.adaptive.method = AdaptiveMethod::paper;
  result.settings.stratify = false;
  result.settings.adaptive.min_samples = bounds->min;
  result.settings.adaptive.max_samples = bounds->max;
  result.map = "sampling-probability";
  return result;
}

TraceContender independent_contender(const ExperimentContext& context, const ExperimentScene& scene) {
  TraceContender result = contender(context, scene, nullptr);
  result.name = kIndependent;
  result.settings.stratify = false;
  return result;
}

/// The paper's sample count: the measure includes the reference's noise, which cannot be subtracted.
int reference_spp(const ExperimentContext& context) { return context.choose(4096, 32); }

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene, const std::vector<Bounds>& bounds) {
  const Reference reference = make_reference(context, scene, reference_spp(context));
  std::vector<TraceContender> contenders{contender(context, scene, nullptr)};
  for (const Bounds& b : bounds) contenders.push_back(contender(context, scene, &b));
  contenders.push_back(independent_contender(context, scene));
  const TraceOptions options{.turn = {},
                             .frames = context.quick ? 48u : 128u,
                             .repetitions = context.choose(3, 1),
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .image_frame = 32};
  std::vector<Trace> traces = trace(context, scene.name, scene, contenders, options);
  ImageSet images = trace_images(scene.name, traces, reference.image);
  return {scene.name, scene.property, std::move(traces), std::move(images)};
}

/// Time range of a comparison, in frames of path tracing.
struct Window {
  double begin;
  double end;
};
/// Half to twice the paper's times: 70 ms at 9.3 ms per frame for the box (§4.2.1), 660 ms at 26 ms in Sponza, for
/// which it shows the sample distribution (§4.2.2). According to §5, path tracing catches up later.
constexpr Window kPaperBox{3.75, 15};
constexpr Window kPaperSponza{12.5, 50};
/// Additional range: starts when the threshold has almost reached its final value.
constexpr Window kLate{24, 128};

/// Index of a trace; 0 if it was not measured on this scene.
size_t trace_of(const SceneResult& result, std::string_view name) {
  for (size_t i = 1; i < result.traces.size(); ++i) {
    if (result.traces[i].name == name) return i;
  }
  return 0;
}

Ratio ratio(const SceneResult& result, const Window& window, std::string_view name,
            std::string_view baseline = kPathTracing) {
  return mean_ratio(result.traces, trace_of(result, name), trace_of(result, baseline), &TracePoint::spread,
                    window.begin, window.end);
}

std::string best_of(const SceneResult& result, const Window& window) {
  std::string best;
  for (const Bounds& bounds : kTable) {
    const std::string name = "min/max " + name_of(bounds);
    if (trace_of(result, name) == 0) continue;
    if (best.empty() || ratio(result, window, name).value < ratio(result, window, best).value) best = name;
  }
  return best;
}

ChartBlock charts(const SceneResult& result) {
  return trace_charts(result.name,
                      result.property.empty() ? "The settings of the paper's table 1."
                                              : "A variation of the box: " + result.property + ".",
                      result.traces, &TracePoint::spread, "variance of the distance to the reference");
}

TableBlock table(const std::string& title, const std::string& when, const std::vector<SceneResult>& results,
                 const std::function<Window(const SceneResult&)>& window_of) {
  TableBlock block{title,
                   "Variance of the distance to the reference over that of path tracing, mean over the times " + when +
                       "; below 1 is better. The last column is uniform sampling with independent random numbers, "
                       "which adaptive sampling uses here, too.",
                   "scene",
                   {},
                   {}};
  std::vector<std::string> names;
  for (const Bounds& bounds : kTable) names.push_back("min/max " + name_of(bounds));
  names.emplace_back(kIndependent);
  for (const std::string& name : names) block.columns.push_back({name});
  for (const SceneResult& result : results) {
    TableRow row{.name = result.name, .cells = {}};
    for (const std::string& name : names) {
      if (trace_of(result, name) == 0) {
        row.cells.push_back(TableCell{"–"});
        continue;
      }
      const Ratio value = ratio(result, window_of(result), name);
      row.cells.push_back({share_text(value), value.value});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

void claim_best(const SceneResult* scene, const Window& window, const std::string& id, const std::string& expected,
                std::vector<Claim>& claims) {
  const std::string text = fmt::format("Of table 1, min/max {} is best.", expected);
  const std::string threshold = fmt::format("{} within 3 % of every other", expected);
  if (!scene) {
    claims.push_back(unmeasured(id, kPaper, text, threshold, kNoSponza));
    return;
  }
  const std::string name = "min/max " + expected;
  const std::string best = best_of(*scene, window);
  std::vector<Ratio> ratios;
  for (const Bounds& bounds : kTable) {
    const std::string other = "min/max " + name_of(bounds);
    if (other != name) ratios.push_back(ratio(*scene, window, name, other));
  }
  claims.push_back(judged_within(
      id, kPaper, text,
      fmt::format("best: {} with {} of path tracing; {}: {}", best, share_text(ratio(*scene, window, best)), expected,
                  share_text(ratio(*scene, window, name))),
      threshold, ratios, 0, 1.03));
}

void claim_gain(const SceneResult* scene, const Window& window, const std::string& id, const std::string& name,
                const std::string& bounds, std::vector<Claim>& claims) {
  const std::string text = fmt::format(
      "On {} the variance of the distance to the reference falls faster than with path tracing at equal time.", name);
  const std::string threshold = "ratio to path tracing at most 1";
  if (!scene) {
    claims.push_back(unmeasured(id, kPaper, text, threshold, kNoSponza));
    return;
  }
  const std::string contender_name = "min/max " + bounds;
  const Ratio value = ratio(*scene, window, contender_name);
  claims.push_back(judged_within(
      id, kPaper, text,
      fmt::format("{}, frames {:.3g} to {:.3g}: {} of path tracing's, {} of that with independent samples; later {}",
                  bounds, window.begin, window.end, share_text(value),
                  share_text(ratio(*scene, window, contender_name, kIndependent)),
                  share_text(ratio(*scene, kLate, contender_name))),
      threshold, {value}, 0, 1));
}

void claim_no_gain(const SceneResult& scene, const std::string& id, const std::string& what,
                   std::vector<Claim>& claims) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const char* bounds : {"2/32", "4/32"}) {
    const std::string name = fmt::format("min/max {}", bounds);
    const Ratio early = ratio(scene, kPaperBox, name);
    const Ratio late = ratio(scene, kLate, name);
    measured += fmt::format("{}{}: {}, later {} of path tracing's, {} and {} of that with independent samples",
                            measured.empty() ? "" : "; ", bounds, share_text(early), share_text(late),
                            share_text(ratio(scene, kPaperBox, name, kIndependent)),
                            share_text(ratio(scene, kLate, name, kIndependent)));
    ratios.insert(ratios.end(), {early, late});
  }
  claims.push_back(judged_within(id, kPaper, fmt::format("No gain {}.", what), measured,
                                 "all ratios to path tracing at least 1", ratios, 1));
}

ExperimentResult run_adaptive_sampling(const ExperimentContext& context) {
  const std::vector<Bounds> all(std::begin(kTable), std::end(kTable));
  const std::vector<Bounds> two{{2, 32}, {4, 32}};
  std::vector<SceneResult> results;
  results.push_back(measure(context, closed_box(), all));
  const std::optional<ExperimentScene> hall = sponza(context);
  if (hall) results.push_back(measure(context, *hall, all));
  std::vector<BoxVariation> variations{BoxVariation::directional_light, BoxVariation::reflective};
  if (!context.quick) {
    results.push_back(measure(context, city_street(), two));
    variations = {BoxVariation::point_light,  BoxVariation::directional_light, BoxVariation::triangles_80k,
                  BoxVariation::triangles_1m, BoxVariation::reflective,        BoxVariation::glass};
  }
  for (BoxVariation variation : variations) results.push_back(measure(context, closed_box(variation), two));

  const SceneResult* const box = &named(results, "scene", "closed box");
  const SceneResult* const sponza_hall = hall ? &named(results, "scene", hall->name) : nullptr;
  ExperimentResult result;
  claim_gain(box, kPaperBox, "gain-box", "the box", "4/32", result.claims);
  claim_best(box, kPaperBox, "best-box", "4/32", result.claims);
  claim_gain(sponza_hall, kPaperSponza, "gain-sponza", "Sponza", "2/32", result.claims);
  claim_best(sponza_hall, kPaperSponza, "best-sponza", "2/32", result.claims);
  claim_no_gain(named(results, "scene", "directional light"), "no-gain-directional", "under directional light",
                result.claims);
  claim_no_gain(named(results, "scene", "highly reflective"), "no-gain-reflective", "for highly reflective materials",
                result.claims);
  result.blocks.emplace_back(
      table("Against path tracing at equal time, in the paper's first moments",
            "from half to twice the one named in the paper: 3.75 to 15 frames of path tracing, in Sponza 12.5 to 50",
            results, [&](const SceneResult& scene) { return &scene == sponza_hall ? kPaperSponza : kPaperBox; }));
  result.blocks.emplace_back(table("Later", "from 24 to 128 frames, after the threshold has fallen", results,
                                   [](const SceneResult&) { return kLate; }));
  std::vector<ImageSet> images;
  for (SceneResult& scene : results) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(trace_viewer(
      "Images", "At the time of 32 frames of path tracing. Maps: final probability of a sample.", std::move(images)));
  for (const SceneResult& scene : results) result.blocks.emplace_back(charts(scene));
  result.setup = {
      common_setup(context).front(),
      {"Reference", fmt::format("{} samples per pixel, as in the paper in a full run", reference_spp(context))},
      {"Measure", "variance over the pixels of the distance to the reference's colour, both clamped at 1"},
      {"Repetitions", "three sequences (one in a quick run); contenders take turns frame by frame"}};
  return result;
}

}  // namespace

Experiment adaptive_sampling_experiment() {
  return {"adaptive-sampling", kPaper, "adaptive sampling against uniform sampling", run_adaptive_sampling};
}

}  // namespace relume
