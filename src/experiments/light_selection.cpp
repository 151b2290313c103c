// [Dittebrandt20 §7.1]: ways to choose a light, at one sample a pixel, once they have adapted.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "experiments/adapted_error.h"
#include "experiments/all.h"
#include "experiments/learning_scenes.h"
#include "experiments/trace.h"
#include "report/pictures.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.1]";

// Contenders, in the order in which they are measured.
enum : size_t { kPower, kTree, kLists, kCache, kTreeGuided, kListsGuided, kCacheGuided, kContenders };

struct SceneResult {
  std::string name;
  std::vector<AdaptedError> errors;
  PictureSet pictures;
};

std::vector<AdaptedContender> contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  using enum LightSelectionChoice;
  std::vector<AdaptedContender> list;
  const auto add = [&](std::string name, LightSelectionChoice lights, GuideChoice guide) {
    RenderSettings settings = scene.settings;
    set_size(context, settings);
    settings.lights = lights;
    settings.guide = guide;
    list.push_back({std::move(name), settings});
  };
  add("power", power, GuideChoice::bsdf);
  add("light tree", light_tree, GuideChoice::bsdf);
  add("static lists", static_lists, GuideChoice::bsdf);
  add("vlc", vlc, GuideChoice::bsdf);
  add("light tree, cdq", light_tree, GuideChoice::cdq);
  add("static lists, cdq", static_lists, GuideChoice::cdq);
  add("vlc, cdq", vlc, GuideChoice::cdq);
  return list;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, plainly_sampled(scene), context.choose(2048, 256));
  const AdaptedOptions options{.warm_up = context.choose(128, 8), .frames = context.choose(256, 8)};
  SceneResult result{scene.name, {}, {}};
  result.errors = measure_adapted(context, scene, contenders(context, scene), reference,
                                  {surfaces_of(context, scene)}, options);
  result.pictures = adapted_pictures(scene.name, result.errors, reference.image);
  return result;
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{
      scene.name,
      "Mean squared error of single frames where no lamp is seen, against the light tree's, at equal samples and "
      "at equal time, with 95 % intervals.",
      "lights",
      {{"MSE", "", Better::lower},
       {"ms a frame", "", Better::lower},
       {"times lower than the light tree", "", Better::higher},
       {"at equal time", "", Better::higher}},
      {}};
  const AdaptedError& tree = scene.errors[kTree];
  int color = 0;
  for (const AdaptedError& e : scene.errors) {
    const ErrorRatio ratio = error_ratio(tree.mse[0], e.mse[0]);
    const ErrorRatio equal_time = equal_time_ratio(tree, e);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {to_text(ratio), ratio.value},
                           {to_text(equal_time), equal_time.value}}});
  }
  return block;
}

ErrorRatio against(const SceneResult& scene, size_t worse, size_t better) {
  return error_ratio(scene.errors[worse].mse[0], scene.errors[better].mse[0]);
}

void claim_warehouse(const SceneResult& scene, std::vector<Claim>& claims) {
  for (const auto& [other, name] : {std::pair{kTree, "light tree"}, std::pair{kLists, "static lists"}}) {
    const ErrorRatio ratio = against(scene, other, kCache);
    claims.push_back(judged(fmt::format("warehouse-{}", other == kTree ? "light-tree" : "static-lists"), kPaper,
                            fmt::format("In many rooms the visibility light cache has almost an order of magnitude "
                                        "less error than {}.",
                                        other == kTree ? "the light hierarchy" : "static light lists"),
                            to_text(ratio) + " lower MSE on `warehouse` than the " + name, "at least 5×",
                            ratio.value >= 5));
  }
  const size_t others[] = {kPower, kTree, kLists};
  double least = 1e30;
  std::string measured;
  for (const size_t other : others) {
    const ErrorRatio ratio = equal_time_ratio(scene.errors[other], scene.errors[kCache]);
    least = std::min(least, ratio.value);
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.errors[other].name, to_text(ratio));
  }
  claims.push_back(judged("warehouse-equal-time", "users feel time", "On `warehouse` the cache wins at equal time too.",
                          measured, "every ratio above 1", least > 1));
}

void claim_elsewhere(const std::vector<SceneResult>& scenes, std::vector<Claim>& claims) {
  double least = 1e30;
  std::string measured;
  for (const SceneResult& scene : scenes) {
    const ErrorRatio ratio = against(scene, kTree, kCache);
    least = std::min(least, ratio.value);
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratio));
  }
  claims.push_back(judged("never-worse", kPaper,
                          "Where visibility does not decide, the cache does no harm (against the light tree).",
                          measured, "every ratio at least 1/1.3", least >= 1 / 1.3));
}

void claim_baseline(const SceneResult& field, std::vector<Claim>& claims) {
  const ErrorRatio ratio = against(field, kPower, kTree);
  claims.push_back(judged("tree-is-tuned", "design",
                          "The baseline is no straw man: where nothing is hidden, the light "
                          "tree beats choosing by power.",
                          to_text(ratio) + " lower MSE on 256 lamps over a plain", "above 1", ratio.interval.low > 1));
}

ExperimentResult run_light_selection(const ExperimentContext& context) {
  std::vector<SceneResult> scenes;
  scenes.push_back(measure(context, builtin_scene("warehouse")));
  const SceneResult field = measure(context, lamp_field());
  if (!context.quick) {
    for (const char* name : {"cover", "mine", "turntable", "slit"})
      scenes.push_back(measure(context, builtin_scene(name)));
  }
  const std::optional<ExperimentScene> hall = sponza_with_lamps(context);
  if (hall) scenes.push_back(measure(context, *hall));
  scenes.push_back(field);

  ExperimentResult result;
  claim_warehouse(scenes.front(), result.claims);
  claim_elsewhere(scenes, result.claims);
  claim_baseline(field, result.claims);
  std::vector<PictureSet> pictures;
  for (SceneResult& scene : scenes) pictures.push_back(std::move(scene.pictures));
  result.blocks.emplace_back(
      ViewerBlock{"Pictures", "One frame of one sample a pixel, adapted.", picture_layer_kinds(), std::move(pictures)});
  for (const SceneResult& scene : scenes) result.blocks.emplace_back(table(scene));
  result.setup = adapted_setup(context);
  return result;
}

}  // namespace

Experiment light_selection_experiment() {
  return {"light-selection", kPaper,
          "the lights that were visible nearby in the last frame, against a light tree and static lists",
          run_light_selection};
}

}  // namespace relume
