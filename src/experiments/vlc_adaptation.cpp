// [Dittebrandt20 §7.2]: how fast octree and visibility light cache adapt from nothing.
#include <fmt/format.h>

#include "experiments/adaptation.h"
#include "experiments/all.h"
#include "experiments/learning_scenes.h"
#include "experiments/trace.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.2]";

ExperimentResult run_vlc_adaptation(const ExperimentContext& context) {
  const ExperimentScene scene = builtin_scene("warehouse");
  const Reference reference = make_reference(context, plainly_sampled(scene), context.choose(2048, 256));
  const PictureRegion surfaces = surfaces_of(context, scene);
  RenderSettings settings = scene.settings;
  set_size(context, settings);
  settings.history = HistoryChoice::none;
  settings.lights = LightSelectionChoice::light_tree;
  Session session(Scene(scene.scene), settings);
  session.set_camera(scene.camera);
  const int runs = context.choose(16, 2);
  const Adaptation tree =
      measure_adaptation(context, "light tree", session, runs, context.choose(8, 4), reference, surfaces);
  settings.lights = LightSelectionChoice::vlc;
  session.set_settings(settings);
  const Adaptation cache =
      measure_adaptation(context, "vlc", session, runs, context.choose(64, 8), reference, surfaces);

  ExperimentResult result;
  const size_t after = cache.adapted_after(0.1);
  result.claims.push_back(judged("second-frame", kPaper,
                                 "Already the second frame has a better picture than the first.",
                                 fmt::format("{:.2f}× lower MSE, which is {:.2f}× lower than the light tree's",
                                             cache.mse[0] / cache.mse[1], tree.plateau(tree.mse.size()) / cache.mse[1]),
                                 "lower than the first frame's by 1.5×", cache.mse[0] > 1.5 * cache.mse[1]));
  result.claims.push_back(judged("adapted", kPaper, "After eleven frames octree and cache have adapted.",
                                 fmt::format("within 10 % of the plateau from frame {} on", after + 1), "by frame 11",
                                 after + 1 <= 11));
  result.blocks.emplace_back(adaptation_chart(
      "Warehouse", "Error of single frames from an empty cache; bands are 95 % intervals of the mean over the runs.",
      {cache, tree}, 1));
  result.setup = adapted_setup(context);
  result.setup.emplace_back("Runs", fmt::format("{} seeds", runs));
  return result;
}

}  // namespace

Experiment vlc_adaptation_experiment() {
  return {"vlc-adaptation", kPaper, "from an empty cache to an adapted one", run_vlc_adaptation};
}

}  // namespace relume
