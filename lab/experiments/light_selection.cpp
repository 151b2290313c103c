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
#include "experiments/measure/selection_errors.h"
#include "experiments/setup/base_rooms.h"
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

/// Extent of the measurement.
enum class Extent {
  ways,     ///< each light sampling technique, and the cache with each mode
  tuned,    ///< also static lists with other settings
  layouts,  ///< as `tuned`, without modes, uniform choice and Markov chains
  bases,    ///< as `ways`, with exact lists in place of those from rays, without uniform choice and Markov chains
  rooms,    ///< as `bases`, without modes
};

/// Image scale of the warehouse that gives regions nearly as many samples as in the paper.
constexpr int kWarehouseScale = 3;

/// Adds static lists with cells narrower than a bay of the default warehouse (3 m), and with more exploration to cover
/// lights missing from their lists.
void add_tuned_lists(const ExperimentContext& context, const RenderSettings& base, std::vector<NamedSettings>& list) {
  const std::pair<float, float> tuned[] = {{2.0f, 0.1f}, {2.0f, 0.2f}, {0.0f, 0.2f}};
  for (const auto& [cell, exploration] : tuned) {
    if (context.quick && !(cell == 2 && exploration == 0.1f)) continue;
    const std::string size = cell > 0 ? fmt::format("{:.0f} m", cell) : "4 m";
    list.push_back({fmt::format("{}, {}, {:.0f} % exploration", kLists, size, 100 * exploration), base});
    RenderSettings& s = list.back().settings;
    s.lights = LightSelectionChoice::static_lists;
    s.guide = GuideChoice::bsdf;
    s.static_lists.cell_size = cell;
    s.static_lists.exploration = exploration;
  }
}

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
  const bool all = extent == Extent::ways || extent == Extent::tuned;
  if (all) add("uniform", uniform, GuideChoice::bsdf);
  add("power", power, GuideChoice::bsdf);
  add(kTree, light_tree, GuideChoice::bsdf);
  if (extent == Extent::bases || extent == Extent::rooms) {
    add(kExactLists, static_lists, GuideChoice::bsdf).static_lists.visibility = LightListVisibility::sets;
  } else {
    add(kLists, static_lists, GuideChoice::bsdf);
  }
  use_paper_cache(add(kPaperCache, vlc, GuideChoice::bsdf));
  add(kCache, vlc, GuideChoice::bsdf);
  add("neeat", neeat, GuideChoice::bsdf);
  if (all) add("mcls", mcls, GuideChoice::bsdf);
  if (all || extent == Extent::bases) {
    for (const LearningMode& mode : modes_to_measure(context, cache_modes()))
      mode.apply(add(with_mode(kCache, mode), vlc, GuideChoice::bsdf));
  }
  if (extent == Extent::tuned || extent == Extent::layouts) add_tuned_lists(context, base, list);
  return list;
}

/// Measures a scene; with `room`, only the pixels that show the inside of this room.
SelectionErrors measure(const ExperimentContext& context, const ExperimentScene& scene, Extent extent,
                        const BaseRoom* room = nullptr) {
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  PixelMask surfaces = surfaces_of(context, scene);
  if (room) surfaces = pixels_in_room(surfaces, reference, *scene.camera, *room);
  SelectionErrors result{scene.name, reference_noise(reference, surfaces), {}, {}};
  AdaptedOptions options = adapted_options(context);
  if (extent == Extent::bases || extent == Extent::rooms) options.sessions = 1;  // intervals are over bases
  result.errors = measure_adapted(context, scene, contenders(context, scene, extent), reference, {surfaces}, options);
  result.images = adapted_images(scene.name, result.errors, reference.image);
  return result;
}

/// Errors of the static lists with the lowest `cost`.
template <typename Cost>
const AdaptedError& best_lists(const SelectionErrors& scene, const Cost& cost) {
  const AdaptedError* best = &named(scene.errors, "contender", kLists);
  for (const AdaptedError& e : scene.errors) {
    if (e.name.starts_with(kLists) && cost(e) < cost(*best)) best = &e;
  }
  return *best;
}

TableBlock table(const SelectionErrors& scene) {
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

/// The paper's claim about the cache in the warehouse, for one layout and one variant of the cache's settings.
void claim_layout(const SelectionErrors& scene, const char* cache, const std::string& suffix, const char* source,
                  std::vector<Claim>& claims) {
  const AdaptedError& ours = named(scene.errors, "contender", cache);
  const Ratio tree = against(named(scene.errors, "contender", kTree), ours);
  claims.push_back(judged_ratios(fmt::format("{}-light-tree{}", scene.name, suffix), source,
                                 fmt::format("In many rooms the visibility light cache ({}) has almost an order of "
                                             "magnitude less error than the light hierarchy.",
                                             cache),
                                 fmt::format("{} lower MSE on `{}` than the light tree", to_text(tree), scene.name),
                                 {tree}, 5));
  const AdaptedError& lists = best_lists(scene, [](const AdaptedError& e) { return e.mean_mse(); });
  const Ratio ratio = against(lists, ours);
  claims.push_back(judged_ratios(
      fmt::format("{}-static-lists{}", scene.name, suffix), source,
      fmt::format("In many rooms the visibility light cache ({}) has almost an order of "
                  "magnitude less error than static light lists.",
                  cache),
      fmt::format("{} lower MSE on `{}` than the best lists ({}); {} with their defaults", to_text(ratio), scene.name,
                  lists.name, to_text(against(named(scene.errors, "contender", kLists), ours))),
      {ratio}, 5));
}

/// Claims about the default layout, for one variant of the cache's settings.
void claim_warehouse(const SelectionErrors& scene, const char* cache, const std::string& suffix, const char* source,
                     std::vector<Claim>& claims) {
  claim_layout(scene, cache, suffix, source, claims);
  const AdaptedError& ours = named(scene.errors, "contender", cache);
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
void claim_elsewhere(const std::vector<SelectionErrors>& scenes, const char* cache, const std::string& suffix,
                     std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SelectionErrors& scene : scenes) {
    if (scene.name.starts_with("warehouse")) continue;
    ratios.push_back(against(named(scene.errors, "contender", kTree), named(scene.errors, "contender", cache)));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(
      "never-worse" + suffix, kOurs,
      fmt::format("Where fewer lamps are hidden, the cache ({}) does no harm (against the light tree).", cache),
      measured, ratios, 1 / 1.3));
}

void claim_baseline(const SelectionErrors& field, std::vector<Claim>& claims) {
  const Ratio ratio = against(named(field.errors, "contender", "power"), named(field.errors, "contender", kTree));
  claims.push_back(judged_ratios(
      "tree-is-tuned", "[relume]",
      "The baseline is strong: where nothing is hidden, the light tree has less error than sampling by power.",
      to_text(ratio) + " lower MSE on 256 lamps over a plain", {ratio}, 1));
}

/// Claims about the cache in the bases, for one variant of its settings.
void claim_bases(const std::vector<SelectionErrors>& bases, const char* cache, const std::string& suffix,
                 std::vector<Claim>& claims) {
  const Ratio tree = mean_gain(bases, kTree, cache);
  claims.push_back(judged_ratios("base-light-tree" + suffix, kOurs,
                                 fmt::format("In the bases the visibility light cache ({}) has almost an order of "
                                             "magnitude less error than the light tree.",
                                             cache),
                                 to_text(tree), {tree}, 5));
  const Ratio lists = mean_gain(bases, kExactLists, cache);
  claims.push_back(judged_ratios(
      "base-exact-lists" + suffix, kOurs,
      fmt::format("In the bases the visibility light cache ({}) has less error than exact static lists.", cache),
      to_text(lists), {lists}, 1));
  const Ratio power = mean_gain(bases, "power", cache);
  claims.push_back(judged_ratios(
      "base-power" + suffix, kOurs,
      fmt::format("In the bases the visibility light cache ({}) has less error than choice by power.", cache),
      to_text(power), {power}, 5));
}

/// Claims that the cache gains in each kind of room, for one variant of its settings.
void claim_rooms(const std::vector<RoomErrors>& rooms, const char* cache, const std::string& suffix,
                 std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const RoomErrors& kind : rooms) {
    ratios.push_back(mean_gain(kind.bases, kTree, cache));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", kind.kind, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(
      "base-rooms" + suffix, kOurs,
      fmt::format("The visibility light cache ({}) has less error than the light tree in each kind of room.", cache),
      measured, ratios, 1));
}

/// Claims that decide the modes' defaults.
void claim_modes(const ExperimentContext& context, const std::vector<SelectionErrors>& bases,
                 const std::vector<SelectionErrors>& others, std::vector<Claim>& claims) {
  for (const LearningMode& mode : modes_to_measure(context, cache_modes())) {
    const std::string with = with_mode(kCache, mode);
    claim_gain("base", mode, kCache, "in the bases",
               {{fmt::format("{} bases", bases.size()), mean_gain(bases, kCache, with)}}, claims);
    std::vector<ModeGain> elsewhere;
    for (const SelectionErrors& scene : others) {
      elsewhere.push_back(
          {scene.name, against(named(scene.errors, "contender", kCache), named(scene.errors, "contender", with))});
    }
    claim_harmless("cache", mode, kCache, elsewhere, claims);
  }
}

/// The ten bases, by seeds named in advance; two in a quick run.
std::vector<SelectionErrors> measure_bases(const ExperimentContext& context) {
  std::vector<SelectionErrors> bases;
  for (int seed = 1; seed <= context.choose(10, 2); ++seed)
    bases.push_back(measure(context, learning_scene(fmt::format("base-{}", seed)), Extent::bases));
  return bases;
}

/// Rooms of these bases, by the kind of their lamps; two kinds in a quick run.
std::vector<RoomErrors> measure_rooms(const ExperimentContext& context) {
  std::vector<RoomErrors> rooms;
  for (const BaseLamps lamps : kBaseLamps) {
    if (context.quick && lamps != BaseLamps::strips && lamps != BaseLamps::skylight) continue;
    RoomErrors kind{name_of(lamps), {}};
    for (int seed = 1; seed <= context.choose(10, 2); ++seed) {
      if (const auto view = base_room_view(static_cast<uint32_t>(seed), lamps))
        kind.bases.push_back(measure(context, view->scene, Extent::rooms, &view->room));
    }
    if (!kind.bases.empty()) rooms.push_back(std::move(kind));
  }
  return rooms;
}

/// The other layouts of the warehouse, at the size of the default one. The last is rebuilt from that in which the
/// paper's cache lost to static lists.
std::vector<SelectionErrors> measure_layouts(const ExperimentContext& context) {
  std::vector<SelectionErrors> layouts;
  for (const char* name : {"warehouse-rooms", "warehouse-140", "warehouse-399"}) {
    if (context.quick && name != std::string_view("warehouse-399")) continue;
    ExperimentScene scene = learning_scene(name);
    scene.scale = kWarehouseScale;
    layouts.push_back(measure(context, scene, Extent::layouts));
  }
  return layouts;
}

ExperimentResult run_light_selection(const ExperimentContext& context) {
  std::vector<SelectionErrors> scenes;
  ExperimentScene warehouse = learning_scene("warehouse");
  if (!context.quick) warehouse.scale = kWarehouseScale;
  scenes.push_back(measure(context, warehouse, Extent::tuned));
  const SelectionErrors field = measure(context, lamp_field(), Extent::ways);
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
  const std::vector<SelectionErrors> layouts = measure_layouts(context);
  const std::vector<SelectionErrors> bases = measure_bases(context);
  const std::vector<RoomErrors> rooms = measure_rooms(context);

  ExperimentResult result;
  claim_warehouse(scenes.front(), kPaperCache, "", kPaper, result.claims);
  claim_warehouse(scenes.front(), kCache, "-own", kOurs, result.claims);
  for (const SelectionErrors& layout : layouts) {
    claim_layout(layout, kPaperCache, "", kPaper, result.claims);
    claim_layout(layout, kCache, "-own", kOurs, result.claims);
  }
  claim_elsewhere(scenes, kPaperCache, "", result.claims);
  claim_elsewhere(scenes, kCache, "-own", result.claims);
  claim_baseline(field, result.claims);
  claim_bases(bases, kPaperCache, "", result.claims);
  claim_bases(bases, kCache, "-own", result.claims);
  claim_rooms(rooms, kPaperCache, "", result.claims);
  claim_rooms(rooms, kCache, "-own", result.claims);
  claim_modes(context, bases, scenes, result.claims);
  scenes.insert(scenes.end(), layouts.begin(), layouts.end());
  std::vector<ImageSet> images;
  for (SelectionErrors& scene : scenes) images.push_back(std::move(scene.images));
  images.push_back(bases.front().images);
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SelectionErrors& scene : scenes) result.blocks.emplace_back(table(scene));
  result.blocks.emplace_back(bases_table(bases, kTree, kExactLists));
  result.blocks.emplace_back(rooms_table(rooms, kTree));
  result.setup = adapted_setup(context);
  if (!context.quick)
    result.setup.emplace_back(
        "Warehouse", fmt::format("images {} times as large along each edge, for all layouts", kWarehouseScale));
  result.setup.emplace_back("Bases",
                            fmt::format("seeds 1 to {}, one session each; intervals are over the seeds", bases.size()));
  result.setup.emplace_back("Rooms",
                            "the first room of each kind in the plan of each base, seen from a corner. Errors "
                            "cover only pixels that show the inside of the room");
  result.setup.emplace_back("vlc, as in the paper",
                            "explores with one table, which weighs changed lights by the amount of the change. It "
                            "chooses the buckets of a region uniformly and has no memory. `vlc` has relume's "
                            "extensions: a table for each cell of a coarse grid over the lights, buckets weighted by "
                            "the power and distance of their lights, and a memory of four frames");
  return result;
}

}  // namespace

Experiment light_selection_experiment() {
  return {"light-selection", kPaper, "the visibility light cache against a light tree and static lists",
          run_light_selection};
}

}  // namespace relume
