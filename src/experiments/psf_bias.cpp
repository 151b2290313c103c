// [Schipek22 §6.1], figures 6.5 to 6.14: what is wrong with the average frame, and how far frames stray from it.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/all.h"
#include "experiments/frame_averages.h"
#include "experiments/trace.h"
#include "report/pictures.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";
constexpr float kConstants[] = {0, 0.01f, 0.1f, 1, 10, 100};
constexpr int kReferenceSpp = 1024;

struct SceneAverages {
  std::string name;
  Reference reference;
  std::vector<FrameAverages> caches;  ///< path tracing first
  std::vector<FrameAverages> graphs;  ///< apg with each of `constants`
  std::vector<float> constants;
};

FramePlanOfAverages plan_of(const ExperimentContext& context) {
  return {.skip = context.choose(16, 8), .count = context.choose(48, 8), .repetitions = context.choose(6, 3)};
}

/// Constants that matter to the bias of path graphs where they are quiet.
bool is_moderate(float constant) { return constant == 0.01f || constant == 0.1f || constant == 1; }

/// `all_caches`: every technique, path graphs with moderate constants; else path tracing, psf and all constants.
SceneAverages measure(const ExperimentContext& context, const ExperimentScene& scene, bool all_caches) {
  SceneAverages result{scene.name, make_reference(context, scene, context.choose(kReferenceSpp, 128)), {}, {}, {}};
  const std::vector<NamedSettings> list = cache_contenders(context, scene);
  for (const NamedSettings& contender : list) {
    if (all_caches || contender.name == "path" || contender.name == "psf")
      result.caches.push_back(average_frames(context, scene, contender, plan_of(context), result.reference));
  }
  for (const float constant : kConstants) {
    if (all_caches && !is_moderate(constant)) continue;
    NamedSettings contender{fmt::format("apg, constant {}", constant), list.front().settings};
    contender.settings.cache = CacheChoice::apg;
    contender.settings.apg.variance_constant = constant;
    result.constants.push_back(constant);
    result.graphs.push_back(average_frames(context, scene, contender, plan_of(context), result.reference));
  }
  return result;
}

const FrameAverages& named(const SceneAverages& scene, std::string_view name) {
  return *std::find_if(scene.caches.begin(), scene.caches.end(), [&](const auto& a) { return a.name == name; });
}

TableCell cell(const Estimate& e) { return {short_number(e.value), e.value, "± " + short_number(2 * e.error())}; }

TableBlock table(const SceneAverages& scene) {
  TableBlock block{
      scene.name,
      "Bias²: mean square difference of the average frame from the reference, without what noise adds to it "
      "(noise can make it negative). Variance: of a frame. ±: two standard errors, from independent repetitions.",
      "technique",
      {{"bias²", "", Better::lower}, {"variance", "", Better::lower}, {"bias² + variance", "", Better::lower}},
      {}};
  const auto add = [&](const FrameAverages& a, int color) {
    block.rows.push_back({a.name,
                          color,
                          {cell(a.bias2),
                           cell(a.variance),
                           {short_number(a.bias2.value + a.variance.value), a.bias2.value + a.variance.value}}});
  };
  for (size_t i = 0; i < scene.caches.size(); ++i) add(scene.caches[i], static_cast<int>(i));
  for (const FrameAverages& a : scene.graphs) add(a, kNeutralColor);
  return block;
}

/// Figure 6.14.
ChartBlock curves(const SceneAverages& scene) {
  Curve bias{"bias²", 0, false, {}};
  Curve variance{"variance", 1, false, {}};
  for (size_t i = 0; i < scene.graphs.size(); ++i) {
    const double x = std::max(1e-3, static_cast<double>(scene.constants[i]));  // 0 does not fit on a logarithmic axis
    bias.points.push_back({.x = x, .y = std::max(1e-9, scene.graphs[i].bias2.value)});
    variance.points.push_back({.x = x, .y = scene.graphs[i].variance.value});
  }
  return {scene.name + ": the variance constant",
          "Bias and variance of apg. The leftmost points are those of the constant 0.",
          {{"by constant", "variance constant", "bias², variance", true, true, {bias, variance}}}};
}

ViewerBlock pictures(const std::vector<SceneAverages>& scenes) {
  ViewerBlock block{"Average frames", "What remains when the noise is gone.", picture_layer_kinds(), {}};
  for (const SceneAverages& scene : scenes) {
    std::vector<MeasuredImage> images;
    for (size_t i = 1; i < scene.caches.size(); ++i)
      images.push_back({scene.caches[i].name, static_cast<int>(i), &scene.caches[i].average});
    block.sets.push_back(measured_set(scene.name, scene.reference.image, images, {.values = false}));
  }
  return block;
}

/// The apg with the largest constant whose variance is at most half of path tracing's; nullptr if there is none. The
/// biases have no say in which, or the noise of several would choose the luckiest.
const FrameAverages* quiet_graph(const SceneAverages& scene) {
  const double limit = 0.5 * named(scene, "path").variance.value;
  const FrameAverages* best = nullptr;
  for (const FrameAverages& a : scene.graphs) {
    if (a.variance.value <= limit) best = &a;
  }
  return best;
}

constexpr const char* kBeyondNoise = "a difference beyond two standard errors";

/// That a's bias² is below `factor` times b's.
void claim_less_bias(std::string id, std::string claim, const FrameAverages& a, const FrameAverages& b, double factor,
                     const std::string& note, std::vector<Claim>& claims) {
  claims.push_back({std::move(id), kPaper, std::move(claim),
                    fmt::format("{}: bias² {} against {} of {}, difference {}{}", a.name, with_noise(a.bias2),
                                with_noise(b.bias2), b.name, with_noise(difference(a.bias2, b.bias2)), note),
                    factor == 1 ? kBeyondNoise : fmt::format("below {} times psf's by two standard errors", factor),
                    verdict_below(difference(a.bias2, scaled(b.bias2, factor)))});
}

void claim_graph(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& path = named(scene, "path");
  const FrameAverages* graph = quiet_graph(scene);
  const std::string id = "graph-bias-" + scene.name;
  const std::string claim =
      fmt::format("{}: apg has less bias than psf where its variance is at most half of path tracing's.", scene.name);
  if (!graph) {
    std::string measured = "no constant has so little variance:";
    for (const FrameAverages& a : scene.graphs)
      measured += fmt::format(" {:.2f} of path tracing's with {}", a.variance.value / path.variance.value, a.name);
    claims.push_back(judged(id, kPaper, claim, measured, kBeyondNoise, false));
    return;
  }
  claim_less_bias(id, claim, *graph, named(scene, "psf"), 1,
                  fmt::format("; variance {:.2f} of path tracing's", graph->variance.value / path.variance.value),
                  claims);
}

/// With the same cells the two have nearly the same bias, so that "no more" needs a margin.
void claim_primary(const SceneAverages& scene, std::vector<Claim>& claims) {
  claim_less_bias("primary-bias-" + scene.name, fmt::format("{}: apsf has no more bias than psf.", scene.name),
                  named(scene, "apsf"), named(scene, "psf"), 1.05, "", claims);
}

void claim_least_variance(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& psf = named(scene, "psf");
  const FrameAverages* least = &named(scene, "path");
  for (const FrameAverages& a : scene.graphs) {
    if (a.variance.value < least->variance.value) least = &a;
  }
  std::vector<const char*> verdicts{verdict_below(difference(psf.variance, named(scene, "path").variance))};
  for (const FrameAverages& a : scene.graphs) verdicts.push_back(verdict_below(difference(psf.variance, a.variance)));
  claims.push_back(
      {"least-variance-" + scene.name, kPaper, fmt::format("{}: psf has the least variance.", scene.name),
       fmt::format("psf {}, least of the others: {} with {}, difference {}", with_noise(psf.variance), least->name,
                   with_noise(least->variance), with_noise(difference(psf.variance, least->variance))),
       kBeyondNoise, verdict_of_all(verdicts)});
}

/// Verdicts on all steps from one constant to the next: that a figure falls, or rises.
const char* verdict_on_steps(const std::vector<FrameAverages>& graphs, Estimate FrameAverages::*figure, bool falls) {
  std::vector<const char*> verdicts;
  for (size_t i = 1; i < graphs.size(); ++i) {
    const Estimate& before = graphs[i - 1].*figure;
    const Estimate& after = graphs[i].*figure;
    verdicts.push_back(verdict_below(falls ? difference(after, before) : difference(before, after)));
  }
  return verdict_of_all(verdicts);
}

void claim_monotone(const SceneAverages& scene, std::vector<Claim>& claims) {
  const auto add = [&](const char* id, const char* text, Estimate FrameAverages::*figure, bool falls) {
    std::string measured;
    for (const FrameAverages& a : scene.graphs) {
      measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", a.name.substr(a.name.rfind(' ') + 1),
                              with_noise(a.*figure));
    }
    claims.push_back({id + scene.name, kPaper,
                      fmt::format("{}: the larger the variance constant of apg, the {}.", scene.name, text),
                      "by constant: " + measured,
                      "every step from one constant to the next goes that way by more than two standard errors; fails "
                      "if one goes the other way by as much",
                      verdict_on_steps(scene.graphs, figure, falls)});
  };
  add("monotone-bias-", "less bias", &FrameAverages::bias2, true);
  add("monotone-variance-", "more variance", &FrameAverages::variance, false);
}

ExperimentResult finished(const ExperimentContext& context, std::vector<SceneAverages> scenes,
                          ExperimentResult result) {
  for (const SceneAverages& scene : scenes) result.blocks.emplace_back(table(scene));
  for (const SceneAverages& scene : scenes) result.blocks.emplace_back(curves(scene));
  result.blocks.emplace_back(pictures(scenes));
  const FramePlanOfAverages plan = plan_of(context);
  result.setup = {common_setup(context).front(),
                  {"Frames", fmt::format("{} of one sample a pixel after {} others, {} times with other seeds",
                                         plan.count, plan.skip, plan.repetitions)},
                  {"Reference", fmt::format("{} samples", context.choose(kReferenceSpp, 128))}};
  return result;
}

ExperimentResult run_psf_bias(const ExperimentContext& context) {
  std::vector<SceneAverages> scenes;
  for (const ExperimentScene& scene : cache_scenes(context)) scenes.push_back(measure(context, scene, true));
  ExperimentResult result;
  for (const SceneAverages& scene : scenes) {
    claim_graph(scene, result.claims);
    claim_primary(scene, result.claims);
  }
  claim_without_sponza(
      context, kPaper,
      {{"graph-bias-Sponza", "Sponza: apg has less bias than psf where its variance is at most half of path tracing's.",
        kBeyondNoise},
       {"primary-bias-Sponza", "Sponza: apsf has no more bias than psf.", kBeyondNoise}},
      result.claims);
  return finished(context, std::move(scenes), std::move(result));
}

ExperimentResult run_psf_variance(const ExperimentContext& context) {
  std::vector<SceneAverages> scenes;
  for (const ExperimentScene& scene : cache_scenes(context)) {
    if (scene.name == "cornell" || scene.name == "Sponza") scenes.push_back(measure(context, scene, false));
  }
  ExperimentResult result;
  for (const SceneAverages& scene : scenes) {
    claim_least_variance(scene, result.claims);
    claim_monotone(scene, result.claims);
  }
  claim_without_sponza(
      context, kPaper,
      {{"least-variance-Sponza", "Sponza: psf has the least variance.", kBeyondNoise},
       {"monotone-bias-Sponza", "Sponza: the larger the variance constant of apg, the less bias.", kBeyondNoise},
       {"monotone-variance-Sponza", "Sponza: the larger the variance constant of apg, the more variance.",
        kBeyondNoise}},
      result.claims);
  return finished(context, std::move(scenes), std::move(result));
}

}  // namespace

Experiment psf_bias_experiment() {
  return {"psf-bias", kPaper, "what is wrong with the average frame of caches", run_psf_bias};
}

Experiment psf_variance_experiment() {
  return {"psf-variance", kPaper, "how far frames of caches stray, and the variance constant of path graphs",
          run_psf_variance};
}

}  // namespace relume
