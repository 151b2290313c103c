#include "experiments/measure/scene_averages.h"

#include <algorithm>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr float kConstants[] = {0, 0.01f, 0.1f, 1, 10, 100};
constexpr int kReferenceSpp = 1024;

FramePlanOfAverages plan_of(const ExperimentContext& context) {
  return {.skip = context.choose(32, 8), .count = context.choose(48, 8), .repetitions = context.choose(6, 3)};
}

/// Constants that matter for the bias of path graphs with low variance.
bool is_moderate(float constant) { return constant == 0.01f || constant == 0.1f || constant == 1; }

TableCell cell(const Estimate& e) { return {short_number(e.value), e.value, "± " + short_number(e.half_width())}; }

TableBlock table(const SceneAverages& scene) {
  TableBlock block{
      scene.name,
      "Bias²: mean squared difference between the average frame and the reference, minus the part due to noise (noise "
      "can make it negative). Variance: of a frame, over independent sessions. ±: 95 %, from these.",
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
  for (const FrameAverages& a : scene.options) add(a, kNeutralColor);
  return block;
}

/// Figure 6.14.
ChartBlock curves(const SceneAverages& scene) {
  Curve bias{"bias²", 0, false, {}};
  Curve variance{"variance", 1, false, {}};
  for (size_t i = 0; i < scene.graphs.size(); ++i) {
    const double x = std::max(1e-3, static_cast<double>(scene.constants[i]));  // 0 is not on a logarithmic axis
    bias.points.push_back({.x = x, .y = std::max(1e-9, scene.graphs[i].bias2.value)});
    variance.points.push_back({.x = x, .y = scene.graphs[i].variance.value});
  }
  return {scene.name + ": the variance constant",
          "Bias and variance of apg. The leftmost points are the constant 0.",
          {{"by constant", "variance constant", "bias², variance", true, true, {bias, variance}}}};
}

ViewerBlock images(const std::vector<SceneAverages>& scenes) {
  ViewerBlock block{"Average frames", "The mean of many frames, which shows the bias.", image_layer_kinds(), {}};
  for (const SceneAverages& scene : scenes) {
    std::vector<MeasuredImage> images;
    for (size_t i = 1; i < scene.caches.size(); ++i)
      images.push_back({scene.caches[i].name, static_cast<int>(i), &scene.caches[i].average});
    block.sets.push_back(measured_set(scene.name, scene.reference.image, images, {.values = false}));
  }
  return block;
}

}  // namespace

SceneAverages measure_averages(const ExperimentContext& context, const ExperimentScene& scene, CacheSet caches) {
  SceneAverages result{
      scene.name, make_reference(context, plainly_sampled(scene), context.choose(kReferenceSpp, 16)), {}, {}, {}, {}};
  const bool all = caches == CacheSet::techniques;
  const PixelMask surfaces = surfaces_of(context, scene);
  std::vector<NamedSettings> list = cache_contenders(context, scene);
  if (all) {
    for (NamedSettings& contender : blend_contenders(context, scene)) list.push_back(std::move(contender));
  }
  for (const NamedSettings& contender : list) {
    if (all || contender.name != "apg")  // part of the constants
      result.caches.push_back(average_frames(context, scene, contender, plan_of(context), result.reference, surfaces));
  }
  for (const float constant : kConstants) {
    if (all && !is_moderate(constant)) continue;
    NamedSettings contender{fmt::format("apg, constant {}", constant), list.front().settings};
    contender.settings.cache = CacheChoice::apg;
    contender.settings.apg.feed = kThesisFeed;
    contender.settings.apg.variance_constant = constant;
    result.constants.push_back(constant);
    result.graphs.push_back(average_frames(context, scene, contender, plan_of(context), result.reference, surfaces));
  }
  if (!all || !measures_options(context, scene)) return result;
  for (const NamedSettings& contender : option_contenders(context, scene))
    result.options.push_back(average_frames(context, scene, contender, plan_of(context), result.reference, surfaces));
  return result;
}

void show_averages(const ExperimentContext& context, const std::vector<SceneAverages>& scenes,
                   ExperimentResult& result) {
  for (const SceneAverages& scene : scenes) result.blocks.emplace_back(table(scene));
  for (const SceneAverages& scene : scenes) result.blocks.emplace_back(curves(scene));
  result.blocks.emplace_back(images(scenes));
  const FramePlanOfAverages plan = plan_of(context);
  result.setup = {common_setup(context).front(),
                  {"Frames", fmt::format("{} of one sample per pixel after {} others, {} times with other seeds",
                                         plan.count, plan.skip, plan.repetitions)},
                  {"Reference", fmt::format("{} samples with the light tree", context.choose(kReferenceSpp, 16))},
                  {"Settings", "the defaults; apg.feed 1, as in the thesis"}};
}

}  // namespace relume
