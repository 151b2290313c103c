#include "experiments/measure/guiding_contenders.h"

#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "experiments/measure/learning_modes.h"
#include "experiments/setup/guiding_scenes.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

/// Adds modes whose defaults are open, of `modes` to the paper's settings.
void add_modes(std::span<const LearningMode> modes, const RenderSettings& paper, const RenderSettings& lasting,
               std::vector<NamedSettings>& list) {
  const auto add = [&](const RenderSettings& base, const char* name, const LearningMode& mode) {
    list.push_back({with_mode(name, mode), base});
    mode.apply(list.back().settings);
  };
  for (const LearningMode& mode : modes) add(paper, kGuided[0].name, mode);
  add(lasting, kGuided[1].name, guiding_modes().back());
}

/// Adds Markov chains and, if they need another light selection than the scene's, BSDF sampling with it.
void add_chains(RenderSettings settings, std::vector<NamedSettings>& list) {
  std::string name = kChains;
  if (settings.lights == LightSelectionChoice::vlc) {
    settings.lights = LightSelectionChoice::light_tree;
    list.push_back({"BSDF, light tree", settings});
    name += ", light tree";
  }
  settings.guide = GuideChoice::mcpg;
  list.push_back({std::move(name), settings});
}

}  // namespace

std::vector<NamedSettings> guiding_contenders(const ExperimentContext& context, const ExperimentScene& scene,
                                              GuidingExtent extent) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings, scene.scale);
  std::vector<NamedSettings> list{{"BSDF", settings}};
  RenderSettings sampled = settings;
  sampled.light_selection.environment = true;
  RenderSettings paper = settings;
  paper.guide = GuideChoice::cdq;
  RenderSettings lasting = paper;
  use_lasting_quadtrees(lasting);
  const auto add = [&](const RenderSettings& base, std::string name, const auto& change) {
    RenderSettings s = base;
    change(s);
    list.push_back({std::move(name), s});
  };
  list.push_back({kGuided[0].name, paper});
  list.push_back({kGuided[1].name, lasting});
  if (scene.scale < kLargeScale) {
    if (!scene.settings.light_selection.environment) list.push_back({"BSDF, the environment sampled", sampled});
    add_chains(settings, list);
  }
  if (extent == GuidingExtent::all_modes) add_modes(guiding_modes().last(1), paper, lasting, list);
  if (extent == GuidingExtent::each_mode) add_modes(modes_to_measure(context, guiding_modes()), paper, lasting, list);
  if (extent != GuidingExtent::departures || context.quick) return list;
  for (const int migrations : {4, 16})
    add(paper, fmt::format("{} migrations", migrations), [&](RenderSettings& s) { s.cdq.migrations = migrations; });
  add(paper, "stratified", [](RenderSettings& s) { s.cdq.sampling = QuadtreeSampling::stratified; });
  add(paper, "jitter", [](RenderSettings& s) { s.octree.jitter = 1; });
  add(paper, "a quarter by the BSDF", [](RenderSettings& s) { s.cdq.bsdf_fraction = 0.25f; });
  add(paper, "a memory of 8 frames", [](RenderSettings& s) { s.cdq.memory = 8; });
  add(paper, "spread to leaves around", [](RenderSettings& s) { s.cdq.spread = 1; });
  for (const int bits : {32, 64, 96}) {
    add(paper, fmt::format("{} bits", bits),
        [&](RenderSettings& s) { s.cdq.bits = static_cast<QuadtreeBits>(bits / 32 - 1); });
  }
  add(lasting, "lasting, a quarter by the BSDF", [](RenderSettings& s) { s.cdq.bsdf_fraction = 0.25f; });
  add(lasting, "lasting, stratified", [](RenderSettings& s) { s.cdq.sampling = QuadtreeSampling::stratified; });
  add(lasting, "lasting, 64 bits", [](RenderSettings& s) { s.cdq.bits = QuadtreeBits::b64; });
  return list;
}

}  // namespace relume
