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
  return {.skip = context.choose(24, 8), .count = context.choose(96, 16), .repetitions = 2};
}

/// Constants that matter to the bias of path graphs where they are quiet.
bool is_moderate(float constant) { return constant == 0.01f || constant == 0.1f || constant == 1; }

/// `all_caches`: every technique, path graphs with moderate constants; else path tracing, psf and all constants.
SceneAverages measure(const ExperimentContext& context, const ExperimentScene& scene, bool all_caches) {
  SceneAverages result{scene.name, make_reference(context, scene, context.choose(kReferenceSpp, 128)), {}, {}, {}};
  const std::vector<CacheContender> list = cache_contenders(context, scene);
  for (const CacheContender& contender : list) {
    if (all_caches || contender.name == "path" || contender.name == "psf")
      result.caches.push_back(average_frames(context, scene, contender, plan_of(context), result.reference));
  }
  for (const float constant : kConstants) {
    if (context.quick && constant != 0.01f && constant != 1) continue;
    if (all_caches && !is_moderate(constant)) continue;
    CacheContender contender{fmt::format("apg, constant {}", constant), list.front().settings};
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

TableBlock table(const SceneAverages& scene) {
  TableBlock block{
      scene.name,
      "Bias²: mean square difference of the average frame from the reference, without what noise adds to it "
      "(noise can make it negative). Variance: of a frame.",
      "technique",
      {{"bias²", "", Better::lower}, {"variance", "", Better::lower}, {"bias² + variance", "", Better::lower}},
      {}};
  const auto add = [&](const FrameAverages& a, int color) {
    block.rows.push_back({a.name,
                          color,
                          {{short_number(a.bias2), a.bias2, "± " + short_number(2 * a.bias2_error)},
                           {short_number(a.variance), a.variance},
                           {short_number(a.bias2 + a.variance), a.bias2 + a.variance}}});
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
    bias.points.push_back({.x = x, .y = std::max(1e-9, scene.graphs[i].bias2)});
    variance.points.push_back({.x = x, .y = scene.graphs[i].variance});
  }
  return {scene.name + ": the variance constant",
          "Bias and variance of apg. The leftmost points are those of the constant 0.",
          {{"by constant", "variance constant", "bias², variance", true, true, {bias, variance}}}};
}

ViewerBlock pictures(const std::vector<SceneAverages>& scenes) {
  const PictureOptions options{.tone_map = ToneMap::agx, .exposure = 0, .values = false};
  ViewerBlock block{"Average frames", "What remains when the noise is gone.", picture_layer_kinds(), {}};
  for (const SceneAverages& scene : scenes) {
    const Image& reference = scene.reference.image;
    PictureSet set{
        .label = scene.name, .width = reference.width, .height = reference.height, .pictures = {}, .crops = {}};
    set.pictures.push_back(plain_picture("reference", kNeutralColor, reference, options));
    std::vector<const Image*> images;
    for (size_t i = 1; i < scene.caches.size(); ++i) {
      const FrameAverages& a = scene.caches[i];
      set.pictures.push_back(measured_picture(a.name, static_cast<int>(i), a.average, reference, options));
      images.push_back(&a.average);
    }
    set.crops = interesting_crops(images, reference, 3);
    block.sets.push_back(std::move(set));
  }
  return block;
}

/// The apg with the least bias among those whose variance is at most half of path tracing's; nullptr if there is none.
const FrameAverages* quiet_graph(const SceneAverages& scene) {
  const double limit = 0.5 * named(scene, "path").variance;
  const FrameAverages* best = nullptr;
  const auto consider = [&](const FrameAverages& a) {
    if (a.variance <= limit && (!best || a.bias2 < best->bias2)) best = &a;
  };
  for (const FrameAverages& a : scene.graphs) consider(a);
  return best;
}

void claim_graph(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& path = named(scene, "path");
  const FrameAverages& psf = named(scene, "psf");
  const FrameAverages* graph = quiet_graph(scene);
  const std::string claim =
      fmt::format("{}: apg has less bias than psf where its variance is at most half of path tracing's.", scene.name);
  if (!graph) {
    claims.push_back(judged("graph-bias-" + scene.name, kPaper, claim, "no constant has so little variance",
                            "bias² below psf's", false));
    return;
  }
  claims.push_back(
      judged("graph-bias-" + scene.name, kPaper, claim,
             fmt::format("{}: bias² {} against {}, variance {:.2f} of path tracing's", graph->name,
                         short_number(graph->bias2), short_number(psf.bias2), graph->variance / path.variance),
             "bias² below psf's", graph->bias2 < psf.bias2));
}

void claim_primary(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& psf = named(scene, "psf");
  const FrameAverages& apsf = named(scene, "apsf");
  const double noise = 2 * (psf.bias2_error + apsf.bias2_error);
  claims.push_back(judged(
      "primary-bias-" + scene.name, kPaper, fmt::format("{}: apsf has no more bias than psf.", scene.name),
      fmt::format("bias² {} against {}, ± {}", short_number(apsf.bias2), short_number(psf.bias2), short_number(noise)),
      "bias² at most psf's and the noise", apsf.bias2 <= psf.bias2 + noise));
}

void claim_least_variance(const SceneAverages& scene, std::vector<Claim>& claims) {
  const double psf = named(scene, "psf").variance;
  double least = named(scene, "path").variance;
  std::string name = "path";
  for (const FrameAverages& a : scene.graphs) {
    if (a.variance >= least) continue;
    least = a.variance;
    name = a.name;
  }
  claims.push_back(judged("least-variance-" + scene.name, kPaper,
                          fmt::format("{}: psf has the least variance.", scene.name),
                          fmt::format("psf {}, next {} with {}", short_number(psf), name, short_number(least)),
                          "psf below the others", psf <= least));
}

void claim_monotone(const SceneAverages& scene, std::vector<Claim>& claims) {
  bool holds = true;
  std::string measured;
  for (size_t i = 0; i < scene.graphs.size(); ++i) {
    const FrameAverages& a = scene.graphs[i];
    measured += fmt::format("{}{}: {} / {}", i > 0 ? ", " : "", a.name.substr(a.name.rfind(' ') + 1),
                            short_number(a.bias2), short_number(a.variance));
    if (i == 0) continue;
    const FrameAverages& before = scene.graphs[i - 1];
    holds = holds && a.variance >= 0.98 * before.variance &&
            a.bias2 <= before.bias2 + 2 * (a.bias2_error + before.bias2_error);
  }
  claims.push_back(judged("monotone-" + scene.name, kPaper,
                          fmt::format("{}: the larger the variance constant of apg, the more variance and the less "
                                      "bias.",
                                      scene.name),
                          "bias² / variance with " + measured, "both monotone within the noise (2 % of the variance)",
                          holds));
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
