// [Dittebrandt20 §7.2]: measures how fast octree and visibility light cache adapt from an empty state, and to a base
// where lamps dim and doors open.
#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_modes.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.2]";
constexpr const char* kOurs = "[relume]";

/// Time in `base-1` when its flickering lamps are low, and the first door of the walk is down if it has a leaf. Both
/// differ from time 0.
constexpr float kChanged_s = 2.05f;

/// Frames from which modes are compared, right after a start or a change.
constexpr size_t kEarly = 8;

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

/// Mean MSE of the first frames, by runs.
std::vector<double> early(const Adaptation& adaptation) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs) {
    const size_t frames = std::min(kEarly, run.size());
    means.push_back(mean({run.begin(), run.begin() + static_cast<std::ptrdiff_t>(frames)}));
  }
  return means;
}

/// The light cache without and with each mode.
struct ModeAdaptations {
  Adaptation cache;
  std::vector<Adaptation> modes;  ///< in the order of modes_to_measure()
};

/// Claims that each mode lowers the error of the first frames; `text`: when they are.
void claim_early(const ExperimentContext& context, const char* id, const char* text, const char* scene,
                 const ModeAdaptations& found, std::vector<Claim>& claims) {
  const std::span<const LearningMode> modes = modes_to_measure(context, cache_modes());
  for (size_t i = 0; i < modes.size(); ++i) {
    claim_gain(id, modes[i], found.cache.name, text, {{scene, error_ratio(early(found.cache), early(found.modes[i]))}},
               claims);
  }
}

/// Adapts to `base-1` at time 0, changes the time, and measures the following frames.
ModeAdaptations adapt_to_change(const ExperimentContext& context) {
  ExperimentScene scene = learning_scene("base-1");
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  settings.history = HistoryChoice::none;
  settings.lights = LightSelectionChoice::vlc;
  scene.settings.time_s = kChanged_s;
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  Session session(Scene(scene.scene), settings);
  session.set_camera(scene.camera);
  const auto measure = [&](const std::string& name, const RenderSettings& with) {
    session.set_settings(with);
    const auto prepare = [&](const ExperimentContext& own, Session& s, int frame) {
      if (frame > 0) return;
      for (int i = 0; i < context.choose(64, 8); ++i) {
        own.check_stop();
        s.render_frame();
      }
      s.set_time(kChanged_s);
    };
    return measure_adaptation(context, name, session, context.choose(64, 2), context.choose(64, 20), reference,
                              surfaces, {.start = [](Session& s) { s.set_time(0); }, .before = prepare});
  };
  ModeAdaptations found{measure("vlc", settings), {}};
  for (const LearningMode& mode : modes_to_measure(context, cache_modes())) {
    RenderSettings with = settings;
    mode.apply(with);
    found.modes.push_back(measure(with_mode("vlc", mode), with));
  }
  return found;
}

std::vector<Adaptation> all_of(const ModeAdaptations& found) {
  std::vector<Adaptation> list{found.cache};
  list.insert(list.end(), found.modes.begin(), found.modes.end());
  return list;
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
  ModeAdaptations start{measure_adaptation(context, "vlc", session, runs, frames, reference, surfaces), {}};
  const Adaptation& cache = start.cache;
  for (const LearningMode& mode : modes_to_measure(context, cache_modes())) {
    RenderSettings with = settings;
    mode.apply(with);
    session.set_settings(with);
    start.modes.push_back(measure_adaptation(context, with_mode("vlc", mode), session, context.choose(64, 2), frames,
                                             reference, surfaces));
  }
  use_paper_cache(settings);
  session.set_settings(settings);
  const Adaptation paper =
      measure_adaptation(context, "vlc, as in the paper", session, runs, frames, reference, surfaces);
  const ModeAdaptations change = adapt_to_change(context);

  ExperimentResult result;
  add_claims(paper, tree, "", kPaper, result.claims);
  add_claims(cache, tree, "-own", kOurs, result.claims);
  result.claims.push_back(judged_adapted("base-adapted", kOurs,
                                         "vlc: eleven frames after lamps dim and doors open, the cache has adapted.",
                                         change.cache, 11));
  claim_early(context, "start", "in the first eight frames from an empty cache", "warehouse", start, result.claims);
  claim_early(context, "change", "in the eight frames after lamps dim and doors open", "base-1", change, result.claims);
  result.blocks.emplace_back(
      adaptation_chart("Warehouse",
                       "Error of single frames from an empty cache; bands are 95 % intervals of the mean over the "
                       "runs. `vlc` has relume's extensions: exploration with a table for each cell of a grid, "
                       "weighted buckets, and a memory of four frames.",
                       {cache, paper, tree}, 1));
  result.blocks.emplace_back(
      adaptation_chart("Warehouse, modes", "Error of single frames from an empty cache.", all_of(start), 1));
  result.blocks.emplace_back(adaptation_chart(
      "base-1", "Error of single frames after lamps dim and doors open; frame 0 is the first.", all_of(change), 0));
  result.setup = learning_setup(context);
  result.setup.emplace_back("Runs", fmt::format("{} seeds, {} frames each from an empty cache; {} with the light tree",
                                                runs, frames, context.choose(8, 4)));
  result.setup.emplace_back("Modes", fmt::format("{} seeds; after a change, {} frames to adapt before it",
                                                 context.choose(64, 2), context.choose(64, 8)));
  return result;
}

}  // namespace

Experiment vlc_adaptation_experiment() {
  return {"vlc-adaptation", kPaper, "from an empty cache to an adapted one", run_vlc_adaptation};
}

}  // namespace relume
