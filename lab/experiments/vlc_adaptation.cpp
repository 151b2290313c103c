// [Dittebrandt20 §7.2]: measures how fast octree and visibility light cache adapt from an empty state.
#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.2]";
constexpr const char* kOurs = "[relume]";

/// The paper's claims for one exploration method.
void add_claims(const Adaptation& cache, const Adaptation& tree, const std::string& suffix, const char* source,
                std::vector<Claim>& claims) {
  const Ratio second = error_ratio(cache.at(0), cache.at(1));
  const Ratio better = error_ratio(tree.plateaus(tree.runs.front().size()), cache.at(1));
  claims.push_back(judged_ratios("second-frame" + suffix, source,
                                 cache.name + ": the second frame already has less error than the first.",
                                 fmt::format("{} lower MSE than the first frame's, {} lower than the light tree's",
                                             to_text(second), to_text(better)),
                                 {second}, 1.5));
  claims.push_back(judged_adapted("adapted" + suffix, source,
                                  cache.name + ": after eleven frames octree and cache have adapted.", cache, 11));
}

ExperimentResult run_vlc_adaptation(const ExperimentContext& context) {
  const ExperimentScene scene = learning_scene("warehouse");
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  settings.history = HistoryChoice::none;
  settings.lights = LightSelectionChoice::light_tree;
  Session session(Scene(scene.scene), settings);
  session.set_camera(scene.camera);
  const int runs = context.choose(256, 2);  // rare bright samples dominate, so that few runs would miss them
  const int frames = context.choose(64, 20);
  const Adaptation tree =
      measure_adaptation(context, "light tree", session, runs, context.choose(8, 4), reference, surfaces);
  settings.lights = LightSelectionChoice::vlc;
  session.set_settings(settings);
  const Adaptation cache = measure_adaptation(context, "vlc", session, runs, frames, reference, surfaces);
  use_paper_cache(settings);
  session.set_settings(settings);
  const Adaptation paper =
      measure_adaptation(context, "vlc, as in the paper", session, runs, frames, reference, surfaces);

  ExperimentResult result;
  add_claims(paper, tree, "", kPaper, result.claims);
  add_claims(cache, tree, "-own", kOurs, result.claims);
  result.blocks.emplace_back(
      adaptation_chart("Warehouse",
                       "Error of single frames from an empty cache; bands are 95 % intervals of the mean over the "
                       "runs. `vlc` has relume's extensions: exploration with a table for each cell of a grid, "
                       "weighted buckets, and a memory of four frames.",
                       {cache, paper, tree}, 1));
  result.setup = learning_setup(context);
  result.setup.emplace_back("Runs", fmt::format("{} seeds, {} frames each from an empty cache; {} with the light tree",
                                                runs, frames, context.choose(8, 4)));
  return result;
}

}  // namespace

Experiment vlc_adaptation_experiment() {
  return {"vlc-adaptation", kPaper, "from an empty cache to an adapted one", run_vlc_adaptation};
}

}  // namespace relume
