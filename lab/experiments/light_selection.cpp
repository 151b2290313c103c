// [Dittebrandt20 §7.1]: compares adapted light sampling techniques at one sample per pixel.
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/learning_modes.h"
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
constexpr const char* kPaperCache = "vlc, as in the paper";  // as the preset paper-002
constexpr const char* kTree = "light tree";
constexpr const char* kLists = "static lists";
constexpr const char* kExactLists = "exact lists";  // from visibility through portals

struct SceneResult {
  std::string name;
  double noise = 0;  ///< MSE of the reference over the counted pixels
  std::vector<AdaptedError> errors;
  ImageSet images;
};

/// Extent of the measurement.
enum class Extent {
  ways,   ///< each light sampling technique, and the cache with each mode
  tuned,  ///< also static lists with other settings
  bases,  ///< as `ways`, with exact lists in place of those from rays, and without uniform choice
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
  if (extent != Extent::bases) add("uniform", uniform, GuideChoice::bsdf);
  add("power", power, GuideChoice::bsdf);
  add(kTree, light_tree, GuideChoice::bsdf);
  if (extent == Extent::bases) {
    add(kExactLists, static_lists, GuideChoice::bsdf).static_lists.visibility = LightListVisibility::sets;
  } else {
    add(kLists, static_lists, GuideChoice::bsdf);
  }
  RenderSettings& paper = add(kPaperCache, vlc, GuideChoice::bsdf);
  use_paper_cache(paper);
  add(kCache, vlc, GuideChoice::bsdf);
  add("neeat", neeat, GuideChoice::bsdf);
  if (extent != Extent::bases) add("mcls", mcls, GuideChoice::bsdf);
  for (const LearningMode& mode : modes_to_measure(context, cache_modes()))
    mode.apply(add(with_mode(kCache, mode), vlc, GuideChoice::bsdf));
  if (extent != Extent::tuned) return list;
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
  AdaptedOptions options = adapted_options(context);
  if (extent == Extent::bases) options.sessions = 1;  // intervals are over bases
  result.errors = measure_adapted(context, scene, contenders(context, scene, extent), reference, {surfaces}, options);
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

/// Ratio of `of(scene)`, a quotient in each base: geometric mean, with an interval over the bases.
template <typename Of>
Ratio over_bases(const std::vector<SceneResult>& bases, const Of& of) {
  std::vector<double> quotients;
  for (const SceneResult& scene : bases) quotients.push_back(of(scene).value);
  return geometric_mean(quotients);
}

/// Factor by which contender `b` has less error than `a` in the bases.
Ratio gain_in_bases(const std::vector<SceneResult>& bases, std::string_view a, std::string_view b) {
  return over_bases(bases, [&](const SceneResult& scene) {
    return against(named(scene.errors, "contender", a), named(scene.errors, "contender", b));
  });
}

TableBlock base_table(const std::vector<SceneResult>& bases) {
  TableBlock block{
      fmt::format("Bases ({})", bases.size()),
      "Factor by which the mean squared error of single frames is lower than with the light tree and with exact lists, "
      "at equal samples and times the frame time: geometric means over the bases with 95 % intervals.",
      "lights",
      {{"times lower than the light tree", "", Better::higher},
       {"least and most", "", Better::higher},
       {"times lower than exact lists", "", Better::higher},
       {"tree, times time", "", Better::higher}},
      {}};
  int color = 0;
  for (const AdaptedError& contender : bases.front().errors) {
    const auto against_tree = [&](const SceneResult& scene) {
      return against(named(scene.errors, "contender", kTree), named(scene.errors, "contender", contender.name));
    };
    const Ratio tree = over_bases(bases, against_tree);
    const Ratio lists = gain_in_bases(bases, kExactLists, contender.name);
    const Ratio time = over_bases(bases, [&](const SceneResult& scene) {
      return equal_time_ratio(named(scene.errors, "contender", kTree),
                              named(scene.errors, "contender", contender.name));
    });
    double least = tree.value;
    double most = tree.value;
    for (const SceneResult& scene : bases) {
      least = std::min(least, against_tree(scene).value);
      most = std::max(most, against_tree(scene).value);
    }
    block.rows.push_back({contender.name,
                          color++,
                          {{to_text(tree), tree.value},
                           {fmt::format("{:.2f} to {:.2f}", least, most), least},
                           {to_text(lists), lists.value},
                           {to_text(time), time.value}}});
  }
  return block;
}

/// Claims about the cache in the bases, for one variant of its settings.
void claim_bases(const std::vector<SceneResult>& bases, const char* cache, const std::string& suffix,
                 std::vector<Claim>& claims) {
  const Ratio tree = gain_in_bases(bases, kTree, cache);
  claims.push_back(judged_ratios("base-light-tree" + suffix, kOurs,
                                 fmt::format("In the bases the visibility light cache ({}) has almost an order of "
                                             "magnitude less error than the light tree.",
                                             cache),
                                 to_text(tree), {tree}, 5));
  const Ratio lists = gain_in_bases(bases, kExactLists, cache);
  claims.push_back(judged_ratios(
      "base-exact-lists" + suffix, kOurs,
      fmt::format("In the bases the visibility light cache ({}) has less error than exact static lists.", cache),
      to_text(lists), {lists}, 1));
  const Ratio power = gain_in_bases(bases, "power", cache);
  claims.push_back(judged_ratios(
      "base-power" + suffix, kOurs,
      fmt::format("In the bases the visibility light cache ({}) has less error than choice by power.", cache),
      to_text(power), {power}, 5));
}

/// Claims that decide the modes' defaults.
void claim_modes(const ExperimentContext& context, const std::vector<SceneResult>& bases,
                 const std::vector<SceneResult>& others, std::vector<Claim>& claims) {
  for (const LearningMode& mode : modes_to_measure(context, cache_modes())) {
    const std::string with = with_mode(kCache, mode);
    claim_gain("base", mode, kCache, "in the bases",
               {{fmt::format("{} bases", bases.size()), gain_in_bases(bases, kCache, with)}}, claims);
    std::vector<ModeGain> elsewhere;
    for (const SceneResult& scene : others) {
      elsewhere.push_back(
          {scene.name, against(named(scene.errors, "contender", kCache), named(scene.errors, "contender", with))});
    }
    claim_harmless("cache", mode, kCache, elsewhere, claims);
  }
}

/// The ten bases, by seeds named in advance; two in a quick run.
std::vector<SceneResult> measure_bases(const ExperimentContext& context) {
  std::vector<SceneResult> bases;
  for (int seed = 1; seed <= context.choose(10, 2); ++seed)
    bases.push_back(measure(context, learning_scene(fmt::format("base-{}", seed)), Extent::bases));
  return bases;
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
    for (const char* name : {"cover", "mine", "turntable", "slit", "skylight"})
      scenes.push_back(measure(context, learning_scene(name), Extent::ways));
  }
  const std::optional<ExperimentScene> hall = sponza_with_lamps(context);
  if (hall) scenes.push_back(measure(context, *hall, Extent::ways));
  scenes.push_back(field);
  const std::vector<SceneResult> bases = measure_bases(context);

  ExperimentResult result;
  claim_warehouse(scenes.front(), kPaperCache, "", kPaper, result.claims);
  claim_warehouse(scenes.front(), kCache, "-own", kOurs, result.claims);
  claim_elsewhere(scenes, kPaperCache, "", result.claims);
  claim_elsewhere(scenes, kCache, "-own", result.claims);
  claim_baseline(field, result.claims);
  claim_bases(bases, kPaperCache, "", result.claims);
  claim_bases(bases, kCache, "-own", result.claims);
  claim_modes(context, bases, scenes, result.claims);
  std::vector<ImageSet> images;
  for (SceneResult& scene : scenes) images.push_back(std::move(scene.images));
  images.push_back(bases.front().images);
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : scenes) result.blocks.emplace_back(table(scene));
  result.blocks.emplace_back(base_table(bases));
  result.setup = adapted_setup(context);
  if (!context.quick)
    result.setup.emplace_back("Warehouse", fmt::format("{} times as large along each edge", kWarehouseScale));
  result.setup.emplace_back("Bases",
                            fmt::format("seeds 1 to {}, one session each; intervals are over the seeds", bases.size()));
  result.setup.emplace_back("vlc, as in the paper",
                            "explores with one table, which weighs changed lights by the amount of the change, "
                            "chooses the buckets of a region uniformly and has no memory; `vlc` has relume's "
                            "extensions: a table for each cell of a coarse grid over the lights, "
                            "buckets weighted by the power and distance of their lights, and a memory of four frames");
  return result;
}

}  // namespace

Experiment light_selection_experiment() {
  return {"light-selection", kPaper, "the visibility light cache against a light tree and static lists",
          run_light_selection};
}

}  // namespace relume
