// [Alber25]: measures how fast Markov chains adapt to a sudden change in light direction, beside quadtrees.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr float kDegreesPerSecond = 36;  // speed of the turntable
constexpr float kTurns[] = {9, 36};      // degrees
constexpr const char* kChains = "mcpg";
constexpr const char* kWithoutRecovery = "mcpg, no recovery";
constexpr const char* kTrees = "cdq";
constexpr const char* kLasting = "cdq, lasting";

/// All contenders keep next event estimation.
std::vector<NamedSettings> contenders(const RenderSettings& base) {
  std::vector<NamedSettings> list{{kTrees, base}, {kLasting, base}, {kChains, base}, {kWithoutRecovery, base}};
  list[0].settings.guide = list[1].settings.guide = GuideChoice::cdq;
  use_lasting_quadtrees(list[1].settings);
  list[2].settings.guide = list[3].settings.guide = GuideChoice::mcpg;
  list[3].settings.mcpg.recovery = false;
  return list;
}

/// Adaptations of all contenders after a turn. Frame 0 is the first one after it.
std::vector<Adaptation> measure(const ExperimentContext& context, const ExperimentScene& scene, float degrees) {
  ExperimentScene turned = scene;
  turned.settings.time_s = degrees / kDegreesPerSecond;
  const Reference reference = make_reference(context, plainly_sampled(turned), learning_reference_spp(context));
  const PixelMask region = pixels_of_material(context, turned, "floor");
  RenderSettings base = scene.settings;
  set_size_and_device(context, base);
  base.history = HistoryChoice::none;
  const int warm_up = context.choose(128, 8);
  const auto prepare = [&](const ExperimentContext& own, Session& session, int frame) {
    if (frame > 0) return;
    for (int i = 0; i < warm_up; ++i) {
      own.check_stop();
      session.render_frame();
    }
    session.set_time(turned.settings.time_s);
  };
  std::vector<Adaptation> list;
  for (const NamedSettings& contender : contenders(base)) {
    Session session(Scene(scene.scene), contender.settings);
    session.set_camera(scene.camera);
    list.push_back(measure_adaptation(context, fmt::format("{:.0f}°, {}", degrees, contender.name), session,
                                      context.choose(32, 2), context.choose(64, 28), reference, region,
                                      {.start = [](Session& s) { s.set_time(0); }, .before = prepare}));
    list.back().name = contender.name;
  }
  return list;
}

/// MSE of the first frames, by runs.
std::vector<double> early(const Adaptation& adaptation, size_t frames) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs)
    means.push_back(mean({run.begin(), run.begin() + static_cast<std::ptrdiff_t>(std::min(frames, run.size()))}));
  return means;
}

void claim_turn(const std::vector<Adaptation>& list, float degrees, size_t frames, std::vector<Claim>& claims) {
  const Adaptation& chains = named(list, "contender", kChains);
  const Adaptation& trees = named(list, "contender", kTrees);
  const Adaptation& frozen = named(list, "contender", kWithoutRecovery);
  claims.push_back(judged_adapted(fmt::format("readapts-{:.0f}", degrees), kOurs,
                                  fmt::format("After {:.0f}° chains readapt in at most {} frames, about as many as "
                                              "[Dittebrandt20 §7.3] states for quadtrees.",
                                              degrees, frames),
                                  chains, frames));
  const Ratio of_chains = chains.over_plateau(0, frames);
  const Ratio of_trees = trees.over_plateau(0, frames);
  const Ratio ratio = quotient(of_chains, of_trees);
  claims.push_back(judged_within(
      fmt::format("faster-{:.0f}", degrees), kOurs, "Chains readapt faster than quadtrees.",
      fmt::format("after {:.0f}° mcpg has {} times its settled MSE in the first {} frames, cdq {}: {} of it", degrees,
                  to_text(of_chains), frames, to_text(of_trees), to_text(ratio)),
      "below 1", {ratio}, 0, 1));
  const Ratio first = error_ratio(early(frozen, frames), early(chains, frames));
  claims.push_back(judged_ratios(fmt::format("recovery-{:.0f}", degrees), kOurs,
                                 "Ending chains whose light has vanished lowers the error after the turn.",
                                 fmt::format("{} less MSE in the first {} frames", to_text(first), frames), {first},
                                 1));
}

ExperimentResult run_mcpg_adaptation(const ExperimentContext& context) {
  const ExperimentScene scene = learning_scene("turntable-spot");
  ExperimentResult result;
  for (const float degrees : kTurns) {
    const std::vector<Adaptation> list = measure(context, scene, degrees);
    claim_turn(list, degrees, degrees < 20 ? 10 : 20, result.claims);
    result.blocks.emplace_back(adaptation_chart(
        fmt::format("The narrow beam turns by {:.0f}°", degrees),
        "Error of single frames after the change; bands are 95 % intervals of the mean over the runs.", list, 0));
  }
  result.setup = learning_setup(context);
  result.setup.emplace_back("Runs", fmt::format("{} seeds; each has {} frames to adapt and {} after the change; errors "
                                                "over the pixels of the floor",
                                                context.choose(32, 2), context.choose(128, 8), context.choose(64, 28)));
  return result;
}

}  // namespace

Experiment mcpg_adaptation_experiment() {
  return {"mcpg-adaptation", "[Alber25]", "Markov chains beside quadtrees after a sudden move of the light",
          run_mcpg_adaptation};
}

}  // namespace relume
