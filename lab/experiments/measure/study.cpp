#include "experiments/measure/study.h"

#include <algorithm>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

/// Replaces the scene's cameras by the experiment's camera, if any.
Scene with_camera(const ExperimentScene& from) {
  Scene scene = from.scene;
  if (!from.camera) return scene;
  for (Node& node : scene.nodes) node.camera = kNone;
  scene.cameras = {from.camera->camera};
  scene.cameras.front().name = "camera";
  Node node;
  node.name = "camera";
  node.camera = 0;
  node.matrix = from.camera->to_world;
  scene.add_node(std::move(node));
  return scene;
}

/// Flags of the scene's settings, then of the experiment's.
std::vector<std::pair<std::string, std::string>> flags(const ExperimentContext& context, const ExperimentScene& scene,
                                                       const StudyOptions& options) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings, scene.scale);
  RenderSettings defaults;
  const SettingList list = describe(settings);
  std::vector<std::pair<std::string, std::string>> result;
  for (const Setting* setting : differing_settings(list, describe(defaults)))
    result.emplace_back(setting->name, to_string(*setting));
  result.insert(result.end(), options.common.begin(), options.common.end());
  return result;
}

template <typename T>
Block titled(const std::string& title, T block) {
  block.title = title + ": " + block.title;
  return block;
}

}  // namespace

Comparison study(const ExperimentContext& context, const ExperimentScene& scene, const StudyOptions& options) {
  ComparisonOptions o;
  o.scene_name = scene.name;
  o.contenders = parse_contenders(options.techniques, scene.name);
  o.common.flags = flags(context, scene, options);
  o.spp = options.spp;
  o.budget_s = context.quick ? options.budget_s / 40 : options.budget_s;
  o.repetitions = context.choose(options.repetitions, std::min(options.repetitions, 2));
  o.times_s = options.times_s;
  o.reference_settings = options.reference;
  o.reference_spp = context.choose(options.reference_spp, std::min(options.reference_spp, 16));
  o.cache_folder = context.cache_folder;
  o.program = context.program;
  o.keep_images = true;
  o.timed = options.timed;
  o.on_all_ranks = true;
  std::optional<Comparison> result = compare(
      with_camera(scene), o, context.stop,
      [&](const std::string& stage, double fraction) {
        context.report(fmt::format("{}, {}", scene.name, stage), fraction);
      },
      context.ranks);
  if (!result) throw ExperimentStopped();
  return std::move(*result);
}

std::vector<float> frame_times(int count) {
  std::vector<float> times;
  for (int i = 0; i < count; ++i) times.push_back(static_cast<float>(i) / 24);
  return times;
}

const ContenderResult& contender_named(const Comparison& comparison, std::string_view name) {
  return named(comparison.contenders, "contender", name);
}

std::vector<Block> study_blocks(const std::string& title, const Comparison& comparison) {
  return {titled(title, comparison_images(comparison)), titled(title, comparison_table(comparison)),
          titled(title, comparison_curves(comparison)), titled(title, comparison_frame_times(comparison))};
}

}  // namespace relume
