// [Dittebrandt20 §7.1]: compares adapted light sampling techniques at one sample per pixel.
#include <utility>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.1]";

constexpr const char* kOurs = "[relume]";
constexpr const char* kCache = "vlc";                        // with relume's extensions
constexpr const char* kPaperCache = "vlc, as in the paper";  // single table for exploration, uniform buckets
constexpr const char* kTree = "light tree";
constexpr const char* kLists = "static lists";

struct SceneResult {
  std::string name;
  double noise = 0;  ///< MSE of the reference over the counted pixels
  std::vector<AdaptedError> errors;
  ImageSet images;
};

/// Extent of the measurement.
enum class Extent {
  ways,   ///< each light sampling technique
  tuned,  ///< also static lists with other settings
};

/// Image scale of the warehouse that gives regions nearly as many samples as in the paper.
constexpr int kWarehouseScale = 3;

std::vector<NamedSettings> contenders(const ExperimentContext& context, const ExperimentScene& scene, Extent extent) {
  using enum LightSelectionChoice;
  std::vector<NamedSettings> list;
  RenderSettings base = scene.settings;
  set_size_and_device(context, base, scene.scale);
  if (context.quick) base.static_lists.rays = 32;
  const auto add = [&](std::string name, LightSelectionChoice lights, GuideChoice guide) -> RenderSettings& {
    list.push_back({std::move(name), base});
    list.back().settings.lights = lights;
    list.back().settings.guide = guide;
    return list.back().settings;
  };
  add("uniform", uniform, GuideChoice::bsdf);
  add("power", power, GuideChoice::bsdf);
  add(kTree, light_tree, GuideChoice::bsdf);
  add(kLists, static_lists, GuideChoice::bsdf);
  RenderSettings& paper = add(kPaperCache, vlc, GuideChoice::bsdf);
  use_paper_cache(paper);
  add(kCache, vlc, GuideChoice::bsdf);
  if (extent == Extent::ways) return list;
  // Cells narrower than a bay of the warehouse (3 m), and more exploration to cover lights missing from their lists.
  const std::pair<float, float> tuned[] = {{2.0f, 0.1f}, {2.0f, 0.2f}, {0.0f, 0.2f}};
  for (const auto& [cell, exploration] : tuned) {
    if (context.quick && !(cell == 2 && exploration == 0.1f)) continue;
    const std::string size = cell > 0 ? fmt::format("{:.0f} m", cell) : "4 m";
    RenderSettings& s = add(fmt::format("{}, {}, {:.0f} % exploration", kLists, size, 100 * exploration), static_lists,
                            GuideChoice::bsdf);
    s.static_lists.cell_size = cell;
    s.static_lists.exploration = exploration;
  }
  return list;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene, Extent extent) {
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  SceneResult result{scene.name, reference_noise(reference, surfaces), {}, {}};
  result.errors = measure_adapted(context, scene, contenders(context, scene, extent), reference, {surfaces},
                                  adapted_options(context));
  result.images = adapted_images(scene.name, result.errors, reference.image);
  return result;
}

/// Errors of the static lists with the lowest `cost`.
template <typename Cost>
const AdaptedError& best_lists(const SceneResult& scene, const Cost& cost) {
  const AdaptedError* best = &named(scene.errors, "contender", kLists);
  for (const AdaptedError& e : scene.errors) {
    if (e.name.starts_with(kLists) && cost(e) < cost(*best)) best = &e;
  }
  return *best;
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{
      scene.name,
      fmt::format("Mean squared error of single frames where no lamp is visible, against the light tree's, at equal "
                  "samples and times the frame time, with 95 % intervals. The reference's own ({:.1e}) is subtracted.",
                  scene.noise),
      "lights",
      {{"MSE", "", Better::lower},
       {"ms per frame", "", Better::lower},
       {"times lower than the light tree", "", Better::higher},
       {"times time", "", Better::higher}},
      {}};
  const AdaptedError& tree = named(scene.errors, "contender", kTree);
  int color = 0;
  for (const AdaptedError& e : scene.errors) {
    const Ratio ratio = error_ratio(tree.mse[0], e.mse[0]);
    const Ratio equal_time = equal_time_ratio(tree, e);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {to_text(ratio), ratio.value},
                           {to_text(equal_time), equal_time.value}}});
  }
  return block;
}

Ratio against(const AdaptedError& worse, const AdaptedError& better) {
  return error_ratio(worse.mse[0], better.mse[0]);
}

/// Claims of the paper about the cache, for one variant of its settings.
void claim_warehouse(const SceneResult& scene, const char* cache, const std::string& suffix, const char* source,
                     std::vector<Claim>& claims) {
  const AdaptedError& ours = named(scene.errors, "contender", cache);
  const Ratio tree = against(named(scene.errors, "contender", kTree), ours);
  claims.push_back(judged_ratios("warehouse-light-tree" + suffix, source,
                                 fmt::format("In many rooms the visibility light cache ({}) has almost an order of "
                                             "magnitude less error than the light hierarchy.",
                                             cache),
                                 to_text(tree) + " lower MSE on `warehouse` than the light tree", {tree}, 5));
  const AdaptedError& lists = best_lists(scene, [](const AdaptedError& e) { return e.mean_mse(); });
  const Ratio ratio = against(lists, ours);
  claims.push_back(judged_ratios(
      "warehouse-static-lists" + suffix, source,
      fmt::format("In many rooms the visibility light cache ({}) has almost an order of "
                  "magnitude less error than static light lists.",
                  cache),
      fmt::format("{} lower MSE on `warehouse` than the best lists ({}); {} with their "
                  "defaults",
                  to_text(ratio), lists.name, to_text(against(named(scene.errors, "contender", kLists), ours))),
      {ratio}, 5));
  std::vector<Ratio> ratios;
  std::string measured;
  const AdaptedError& fast = best_lists(scene, [](const AdaptedError& e) { return e.mean_mse() * e.median_s(); });
  for (const AdaptedError* other :
       {&named(scene.errors, "contender", "uniform"), &named(scene.errors, "contender", "power"),
        &named(scene.errors, "contender", kTree), &fast}) {
    ratios.push_back(equal_time_ratio(*other, ours));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", other->name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(
      "warehouse-equal-time" + suffix, "[relume]",
      fmt::format("On `warehouse` the cache ({}) has the lower product of MSE and frame time, too.", cache), measured,
      ratios, 1));
}

/// Claims about all scenes except `warehouse`, which has its own.
void claim_elsewhere(const std::vector<SceneResult>& scenes, const char* cache, const std::string& suffix,
                     std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : scenes) {
    if (scene.name.starts_with("warehouse")) continue;
    ratios.push_back(against(named(scene.errors, "contender", kTree), named(scene.errors, "contender", cache)));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(
      "never-worse" + suffix, kOurs,
      fmt::format("Where fewer lamps are hidden, the cache ({}) does no harm (against the light tree).", cache),
      measured, ratios, 1 / 1.3));
}

void claim_baseline(const SceneResult& field, std::vector<Claim>& claims) {
  const Ratio ratio = against(named(field.errors, "contender", "power"), named(field.errors, "contender", kTree));
  claims.push_back(judged_ratios(
      "tree-is-tuned", "[relume]",
      "The baseline is strong: where nothing is hidden, the light tree has less error than sampling by power.",
      to_text(ratio) + " lower MSE on 256 lamps over a plain", {ratio}, 1));
}

ExperimentResult run_light_selection(const ExperimentContext& context) {
  std::vector<SceneResult> scenes;
  ExperimentScene warehouse = learning_scene("warehouse");
  if (!context.quick) warehouse.scale = kWarehouseScale;
  scenes.push_back(measure(context, warehouse, Extent::tuned));
  const SceneResult field = measure(context, lamp_field(), Extent::ways);
  if (!context.quick) {
    ExperimentScene small = learning_scene("warehouse");
    small.name = "warehouse, small";
    scenes.push_back(measure(context, small, Extent::ways));
    for (const char* name : {"cover", "mine", "turntable", "slit"})
      scenes.push_back(measure(context, learning_scene(name), Extent::ways));
  }
  const std::optional<ExperimentScene> hall = sponza_with_lamps(context);
  if (hall) scenes.push_back(measure(context, *hall, Extent::ways));
  scenes.push_back(field);

  ExperimentResult result;
  claim_warehouse(scenes.front(), kPaperCache, "", kPaper, result.claims);
  claim_warehouse(scenes.front(), kCache, "-own", kOurs, result.claims);
  claim_elsewhere(scenes, kPaperCache, "", result.claims);
  claim_elsewhere(scenes, kCache, "-own", result.claims);
  claim_baseline(field, result.claims);
  std::vector<ImageSet> images;
  for (SceneResult& scene : scenes) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : scenes) result.blocks.emplace_back(table(scene));
  result.setup = adapted_setup(context);
  if (!context.quick)
    result.setup.emplace_back("Warehouse", fmt::format("{} times as large along each edge", kWarehouseScale));
  result.setup.emplace_back("vlc, as in the paper",
                            "explores with one table, chooses the buckets of a region uniformly and has no memory; "
                            "`vlc` has relume's extensions: a table for each cell of a coarse grid over the lights, "
                            "buckets weighted by the power and distance of their lights, and a memory of four frames");
  return result;
}

}  // namespace

Experiment light_selection_experiment() {
  return {"light-selection", kPaper, "the visibility light cache against a light tree and static lists",
          run_light_selection};
}

}  // namespace relume
