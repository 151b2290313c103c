// [Schalk18 §4.2]: the variance of the distance to the reference, with samples where the noise is and with the same
// number everywhere.
#include <algorithm>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schalk18 §4.2]";

/// The paper's table 1.
struct Bounds {
  int min;
  int max;
};
constexpr Bounds kTable[] = {{2, 16}, {4, 16}, {8, 16}, {2, 32}, {4, 32}, {8, 32}, {16, 32}};

std::string name_of(const Bounds& bounds) { return fmt::format("{}/{}", bounds.min, bounds.max); }

constexpr const char* kPathTracing = "path tracing";
/// The same number of samples everywhere, with random numbers that are independent from frame to frame, as adaptive
/// sampling must draw them: what is lost against path tracing's low-discrepancy points, and what the paper compares
/// with.
constexpr const char* kIndependent = "independent samples";

struct SceneResult {
  std::string name;
  std::string property;
  std::vector<Trace> traces;  ///< the first is path tracing
  PictureSet pictures;
};

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, const Bounds* bounds) {
  TraceContender result{.name = bounds ? "min/max " + name_of(*bounds) : kPathTracing, .settings = scene.settings};
  set_size(context, result.settings);
  if (!bounds) return result;
  result.settings.allocation = AllocationChoice::adaptive;
  result.settings.adaptive.min_samples = bounds->min;
  result.settings.adaptive.max_samples = bounds->max;
  result.map = "sampling-probability";
  return result;
}

TraceContender independent_contender(const ExperimentContext& context, const ExperimentScene& scene) {
  constexpr int kNever = 4096;  // so long every pixel gets its sample
  const Bounds bounds{kNever, kNever + 1};
  TraceContender result = contender(context, scene, &bounds);
  result.name = kIndependent;
  result.map.clear();
  return result;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene, const std::vector<Bounds>& bounds) {
  const Reference reference = make_reference(context, scene);
  std::vector<TraceContender> contenders{contender(context, scene, nullptr)};
  for (const Bounds& b : bounds) contenders.push_back(contender(context, scene, &b));
  contenders.push_back(independent_contender(context, scene));
  const TraceOptions options{.turn = {},
                             .frames = context.quick ? 48u : 128u,
                             .repetitions = 1,
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .picture_frame = 32};
  std::vector<Trace> traces = trace(context, scene.name, scene, contenders, options);
  PictureSet pictures = trace_pictures(scene.name, traces, reference.image);
  return {scene.name, scene.property, std::move(traces), std::move(pictures)};
}

/// nullptr if it was not measured on this scene.
const Trace* trace_of(const SceneResult& result, std::string_view name) {
  for (const Trace& t : result.traces) {
    if (t.name == name) return &t;
  }
  return nullptr;
}

/// Over the times at which the paper compares: from when the threshold has nearly come down, to the end. 1 if one of
/// the two was not measured.
double ratio(const SceneResult& result, std::string_view name, std::string_view baseline) {
  const Trace* a = trace_of(result, name);
  const Trace* b = trace_of(result, baseline);
  if (!a || !b) return 1;
  const Trace& path = result.traces.front();
  double begin_s = path.points.back().time_s / 4;
  for (const TracePoint& p : path.points) {
    if (p.frames >= 24) {
      begin_s = p.time_s;
      break;
    }
  }
  return mean_ratio(*a, *b, &TracePoint::spread, begin_s, path.points.back().time_s);
}

double ratio_to_path(const SceneResult& result, std::string_view name) { return ratio(result, name, kPathTracing); }

std::string best_of(const SceneResult& result) {
  std::string best;
  for (const Bounds& bounds : kTable) {
    const std::string name = "min/max " + name_of(bounds);
    if (trace_of(result, name) && (best.empty() || ratio_to_path(result, name) < ratio_to_path(result, best)))
      best = name;
  }
  return best;
}

ChartBlock charts(const SceneResult& result) {
  return trace_charts(result.name,
                      result.property.empty() ? "The settings of the paper's table 1."
                                              : "A variation of the box: " + result.property + ".",
                      result.traces, &TracePoint::spread, "variance of the distance to the reference");
}

TableBlock table(const std::vector<SceneResult>& results) {
  TableBlock block{"Against path tracing at equal time",
                   "Variance of the distance to the reference over that of path tracing, mean over the times after the "
                   "threshold has come down; below 1 is better. The last column is the same number of samples "
                   "everywhere, drawn with random numbers as adaptive sampling must.",
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
      const double value = ratio_to_path(result, name);
      row.cells.push_back(trace_of(result, name) ? TableCell{fmt::format("{:.3f}", value), value} : TableCell{"–"});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

void claim_best(const SceneResult* scene, const std::string& id, const std::string& expected,
                std::vector<Claim>& claims) {
  const std::string text = fmt::format("Of table 1, min/max {} is best.", expected);
  const std::string threshold = fmt::format("{} within 3 % of the best", expected);
  if (!scene) {
    claims.push_back(unmeasured(id, kPaper, text, threshold, kNoSponza));
    return;
  }
  const std::string best = best_of(*scene);
  const double value = ratio_to_path(*scene, "min/max " + expected);
  claims.push_back(judged(id, kPaper, text,
                          fmt::format("best: {} with {:.3f} of path tracing; {}: {:.3f}", best,
                                      ratio_to_path(*scene, best), expected, value),
                          threshold, value <= 1.03 * ratio_to_path(*scene, best)));
}

void claim_gain(const SceneResult* scene, const std::string& id, const std::string& name, const std::string& bounds,
                std::vector<Claim>& claims) {
  const std::string text = fmt::format(
      "On {} the spread of the distance to the reference falls faster than with path tracing at equal time.", name);
  const std::string threshold = "ratio to path tracing below 0.98";
  if (!scene) {
    claims.push_back(unmeasured(id, kPaper, text, threshold, kNoSponza));
    return;
  }
  const std::string contender_name = "min/max " + bounds;
  const double value = ratio_to_path(*scene, contender_name);
  claims.push_back(judged(id, kPaper, text,
                          fmt::format("{} has {:.3f} of path tracing's, {:.3f} of that with independent samples",
                                      bounds, value, ratio(*scene, contender_name, kIndependent)),
                          threshold, value < 0.98));
}

void claim_no_gain(const SceneResult& scene, const std::string& id, const std::string& what,
                   std::vector<Claim>& claims) {
  const double two = ratio_to_path(scene, "min/max 2/32");
  const double four = ratio_to_path(scene, "min/max 4/32");
  claims.push_back(judged(
      id, kPaper, fmt::format("No gain {}.", what),
      fmt::format("2/32: {:.3f}, 4/32: {:.3f} of path tracing's; {:.3f} and {:.3f} of that "
                  "with independent samples",
                  two, four, ratio(scene, "min/max 2/32", kIndependent), ratio(scene, "min/max 4/32", kIndependent)),
      "both ratios at least 0.98", std::min(two, four) >= 0.98));
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

  const SceneResult* const box = &named(results, "closed box");
  const SceneResult* const sponza_hall = hall ? &named(results, hall->name) : nullptr;
  ExperimentResult result;
  claim_gain(box, "gain-box", "the box", "4/32", result.claims);
  claim_best(box, "best-box", "4/32", result.claims);
  claim_gain(sponza_hall, "gain-sponza", "Sponza", "2/32", result.claims);
  claim_best(sponza_hall, "best-sponza", "2/32", result.claims);
  claim_no_gain(named(results, "directional light"), "no-gain-directional", "under directional light", result.claims);
  claim_no_gain(named(results, "highly reflective"), "no-gain-reflective", "for highly reflective materials",
                result.claims);
  result.blocks.emplace_back(table(results));
  std::vector<PictureSet> pictures;
  for (SceneResult& scene : results) pictures.push_back(std::move(scene.pictures));
  result.blocks.emplace_back(trace_viewer(
      "Pictures",
      "After as much time as 32 frames of path tracing take. Maps: the probability of a sample, at the end.",
      std::move(pictures)));
  for (const SceneResult& scene : results) result.blocks.emplace_back(charts(scene));
  result.setup = common_setup(context);
  result.setup.insert(
      result.setup.end(),
      {{"Measure", "variance over the pixels of the distance to the reference's colour, both cut off at 1"},
       {"Repetitions", "one sequence, by which every verdict is given; contenders take turns frame by frame"}});
  return result;
}

}  // namespace

Experiment adaptive_sampling_experiment() {
  return {"adaptive-sampling", kPaper, "samples where the noise is, against the same number everywhere",
          run_adaptive_sampling};
}

}  // namespace relume
