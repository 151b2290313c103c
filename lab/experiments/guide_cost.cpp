// [Dittebrandt20 §7.4]: measures the cost of preparation and sampling.
#include <algorithm>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.4]";

constexpr const char* kOurs = "[relume]";

enum : size_t { kTree, kLists, kPaperCache, kPaperGuided, kCache, kGuided };

struct SceneResult {
  std::string name;
  std::vector<AdaptedError> errors;
};

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  RenderSettings settings = scene.settings;
  settings.width = context.choose(1280, 32);
  settings.height = context.choose(720, 18);
  settings.device = context.device;
  if (context.quick) settings.static_lists.rays = 32;
  std::vector<NamedSettings> list;
  const auto add = [&](std::string name, LightSelectionChoice lights, GuideChoice guide) {
    settings.lights = lights;
    settings.guide = guide;
    list.push_back({std::move(name), settings});
  };
  add("light tree", LightSelectionChoice::light_tree, GuideChoice::bsdf);
  add("static lists", LightSelectionChoice::static_lists, GuideChoice::bsdf);
  const RenderSettings own = settings;
  use_paper_cache(settings);
  add("vlc, as in the paper", LightSelectionChoice::vlc, GuideChoice::bsdf);
  add("vlc, cdq, as in the paper", LightSelectionChoice::vlc, GuideChoice::cdq);
  settings = own;
  add("vlc", LightSelectionChoice::vlc, GuideChoice::bsdf);
  use_lasting_quadtrees(settings);
  add("vlc, lasting cdq", LightSelectionChoice::vlc, GuideChoice::cdq);
  const AdaptedOptions options{
      .warm_up = context.choose(24, 2), .frames = context.choose(40, 4), .sessions = 1, .block = 1};
  return {scene.name, measure_adapted(context, scene, list, {}, {}, options)};
}

/// Whether the pass is part of every frame or a debug view, and thus not preparation.
bool prepares_nothing(const std::string& pass) {
  return pass == "gbuffer" || pass == "trace" || pass == "accumulate" || pass.ends_with("-view");
}

/// Share of a frame outside these passes, including untimed work.
double preparation_share(const AdaptedError& e) {
  const double all = mean(e.frame_s);
  double others = 0;
  for (const auto& [pass, seconds] : e.pass_s) {
    if (prepares_nothing(pass)) others += seconds;
  }
  return all > 0 ? std::max(0.0, 1 - others / all) : 0;
}

BarBlock bars(const SceneResult& scene) {
  BarBlock block{scene.name, "Mean frame time by pass, adapted.", "ms", {}};
  for (const AdaptedError& e : scene.errors) {
    Bar bar{fmt::format("{}, {:.1f} ms", e.name, 1000 * e.median_s()), {}};
    for (const auto& [pass, seconds] : e.pass_s) bar.parts.emplace_back(pass, 1000 * seconds);
    block.bars.push_back(std::move(bar));
  }
  return block;
}

TableBlock memory_table(const std::vector<SceneResult>& scenes) {
  TableBlock block{"Octree", "Statistics of the passes after the last frame with `vlc` and `cdq`.", "scene", {}, {}};
  for (const SceneResult& scene : scenes) {
    TableRow row{scene.name, kNeutralColor, {}};
    for (const PassStatistic& figure : scene.errors[kGuided].figures) {
      if (&scene == &scenes.front()) block.columns.push_back({figure.name});
      row.cells.push_back({fmt::format("{:.4g}", figure.value), figure.value});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

double figure(const AdaptedError& e, std::string_view name) { return named(e.figures, "figure", name).value; }

/// Claim from the measured, not the declared, memory of the passes.
Claim claim_memory(const SceneResult& scene, const std::string& id) {
  const AdaptedError& e = scene.errors[kPaperGuided];
  const double slots = figure(e, "octree.leaf-slots");
  const double counted =
      (figure(e, "octree.place-bytes") + figure(e, "vlc.cache-bytes") + figure(e, "cdq.quadtree-bytes")) / slots;
  return judged(id + "-memory", "[Dittebrandt20 §6.1]",
                scene.name + ": a leaf has 48 bytes, for its quadtree and the positions of its buckets and samples.",
                fmt::format("{:.1f} bytes; tree and links, which the paper does not count, {:.1f}; cached lights "
                            "{:.1f}, memory of lasting quadtrees {:.0f}",
                            counted, figure(e, "octree.tree-bytes") / slots, figure(e, "vlc.entry-bytes") / slots,
                            figure(scene.errors[kGuided], "cdq.memory-bytes") / slots),
                "at most 48", counted <= 48);
}

/// Adds claims for the paper's settings, or for relume's if `own`.
void add_claims(const SceneResult& scene, const std::string& id, bool own, std::vector<Claim>& claims) {
  const AdaptedError& cache = scene.errors[own ? kCache : kPaperCache];
  const AdaptedError& guided = scene.errors[own ? kGuided : kPaperGuided];
  const char* const source = own ? kOurs : kPaper;
  const char* const suffix = own ? "-own" : "";
  const std::string who = scene.name + (own ? ", relume's cache, lasting quadtrees" : ", the paper's settings");
  const double share = std::max(preparation_share(cache), preparation_share(guided));
  claims.push_back(judged(fmt::format("{}-preparation{}", id, suffix), source,
                          who + ": preparing the structures takes a small part of the frame (1.2 of some 17 ms).",
                          fmt::format("{:.1f} %", 100 * share), "at most 10 %", share <= 0.1));
  const Ratio ratio = time_ratio(cache, scene.errors[kLists]);
  claims.push_back(with_verdict(fmt::format("{}-vlc{}", id, suffix), source,
                                who + ": a frame with the cache takes as long as one with static light lists.",
                                to_text(ratio), "at most 1.1, by the interval", verdict_of(ratio.interval, 0, 1.1)));
}

ExperimentResult run_guide_cost(const ExperimentContext& context) {
  std::vector<SceneResult> scenes;
  const std::optional<ExperimentScene> hall = sponza_with_lamps(context);
  if (hall) scenes.push_back(measure(context, *hall));
  scenes.push_back(measure(context, learning_scene("warehouse")));
  ExperimentResult result;
  const auto add_all = [&](const SceneResult& scene, const std::string& id) {
    for (const bool own : {false, true}) add_claims(scene, id, own, result.claims);
    result.claims.push_back(claim_memory(scene, id));
  };
  if (hall) add_all(scenes.front(), "sponza");
  claim_without_sponza(
      context, kPaper,
      {{"sponza-preparation", "Sponza: preparing the structures takes a small part of the frame.", "at most 10 %"},
       {"sponza-vlc", "Sponza: a frame with the cache takes as long as one with static light lists.", "at most 1.1"},
       {"sponza-preparation-own", "Sponza: the same with relume's cache and lasting quadtrees.", "at most 10 %"},
       {"sponza-vlc-own", "Sponza: the same with relume's cache.", "at most 1.1"},
       {"sponza-memory", "Sponza: a leaf takes 48 bytes.", "at most 48 bytes"}},
      result.claims);
  add_all(scenes.back(), "warehouse");
  for (const SceneResult& scene : scenes) result.blocks.emplace_back(bars(scene));
  result.blocks.emplace_back(memory_table(scenes));
  result.setup = {{"Size", context.quick ? "32 × 18" : "1280 × 720"},
                  {"Frames", context.quick ? "4, after 2" : "40, after 24; contenders take turns frame by frame"},
                  {"Path", "two indirect rays, as in the paper"}};
  return result;
}

}  // namespace

Experiment guide_cost_experiment() {
  return {"guide-cost", kPaper, "cost of light sampling and guiding per frame", run_guide_cost};
}

}  // namespace relume
