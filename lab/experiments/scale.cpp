// [Lin26]: rules for the joints of ReSTIR PT in a scene of five sizes. Footprints need no tuning; a fixed distance
// does.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/references.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Lin26]";

/// Metres per unit of the scene, which is 5.5 m wide at 1.
constexpr float kScales[] = {0.01f, 0.1f, 1, 10, 100};
constexpr size_t kOwnScale = 2;
/// The MSE of a rule that needs no tuning stays within this factor of that at the scene's own scale.
constexpr double kMostChange = 1.2;

enum Contender : size_t { kPath, kFootprint, kDistance, kContenders };

constexpr const char* kNames[kContenders] = {"path", "footprint", "distance-2022"};
constexpr const char* kJson[kContenders] = {R"({"reuse": "none"})",
                                            R"({"reuse": "restir-pt", "restir-pt.connect": "footprint"})",
                                            R"({"reuse": "restir-pt", "restir-pt.connect": "distance-2022"})"};

/// The box at a scale. Radiance, and so the image, stay the same.
ExperimentScene scaled_box(float scale) {
  ExperimentScene scene = built_in("cornell", 6);
  scene.name = fmt::format("cornell × {}", scale);
  for (Node& node : scene.scene.nodes) {
    if (node.parent != kNone) continue;
    node.transform.translation *= scale;
    if (node.camera == kNone) node.transform.scale *= scale;
  }
  return scene;
}

struct ScaleResult {
  float scale = 1;
  std::vector<AdaptedError> errors;  ///< by Contender
};

std::vector<float> scales(const ExperimentContext& context) {
  if (context.quick) return {kScales[0], kScales[kOwnScale]};
  return {std::begin(kScales), std::end(kScales)};
}

AdaptedOptions options(const ExperimentContext& context) {
  return {.warm_up = context.choose(48, 3),
          .frames = context.choose(24, 2),
          .sessions = context.choose(8, 2),
          .block = context.choose(24, 2)};
}

ScaleResult measure(const ExperimentContext& context, float scale) {
  const ExperimentScene scene = scaled_box(scale);
  const Reference reference = make_reference(context, scene, context.choose(1024, 16));
  std::vector<NamedSettings> list;
  for (size_t i = 0; i < kContenders; ++i) {
    NamedSettings next{kNames[i], scene.settings};
    settings_from_json(describe(next.settings), kJson[i], next.name);
    set_size_and_device(context, next.settings, scene.scale);
    list.push_back(std::move(next));
  }
  const PixelMask all = mask_of({"image"}, reference.image.width, reference.image.height);
  return {scale, measure_adapted(context, scene, list, reference, {all}, options(context))};
}

const ScaleResult& own_scale(const std::vector<ScaleResult>& all) {
  size_t best = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (all[i].scale == kScales[kOwnScale]) best = i;
  }
  return all[best];
}

/// MSE of a contender at a scale over that at the scene's own.
Ratio change(const std::vector<ScaleResult>& all, const ScaleResult& at, Contender contender) {
  return error_ratio(at.errors[contender].mse[0], own_scale(all).errors[contender].mse[0]);
}

Claim claim_footprint(const std::vector<ScaleResult>& all) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const ScaleResult& result : all) {
    if (&result == &own_scale(all)) continue;
    ratios.push_back(change(all, result, kFootprint));
    measured += fmt::format("{}× {}: {}", measured.empty() ? "" : ", ", result.scale, share_text(ratios.back()));
  }
  return judged_within("footprint", kPaper, "The footprint rule needs no tuning for the size of the scene.",
                       "MSE over that at scale 1, " + measured,
                       fmt::format("within a factor of {} at every scale", kMostChange), ratios, 1 / kMostChange,
                       kMostChange);
}

/// At the smallest scale no pair of vertices is as far apart as the fixed distance.
Claim claim_distance(const std::vector<ScaleResult>& all) {
  const ScaleResult& smallest = all.front();
  const Ratio grown = change(all, smallest, kDistance);
  const Ratio other = error_ratio(smallest.errors[kDistance].mse[0], smallest.errors[kFootprint].mse[0]);
  return judged_ratios("distance", kPaper,
                       "The fixed distance of 2022 fails in a small scene: its error rises above the footprint's.",
                       fmt::format("at × {}, its MSE is {} that at scale 1, and {} that of the footprint rule",
                                   smallest.scale, to_text(grown), to_text(other)),
                       {grown, other}, 1);
}

TableBlock table(const std::vector<ScaleResult>& all, Contender contender) {
  TableBlock block{kNames[contender],
                   "Mean squared error of single frames by the scale of the box, with 95 % intervals.",
                   "scales",
                   {{"MSE", "", Better::lower},
                    {"over that at scale 1", "", Better::none},
                    {"times lower than path", "", Better::higher},
                    {"rays per pixel", "", Better::lower}},
                   {}};
  int color = 0;
  for (const ScaleResult& result : all) {
    const AdaptedError& e = result.errors[contender];
    const Ratio changed = change(all, result, contender);
    const Ratio gain = error_ratio(result.errors[kPath].mse[0], e.mse[0]);
    block.rows.push_back({fmt::format("× {}", result.scale),
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {share_text(changed), changed.value},
                           {to_text(gain), gain.value},
                           {fmt::format("{:.2f}", e.rays), e.rays}}});
  }
  return block;
}

ExperimentResult run_scale(const ExperimentContext& context) {
  std::vector<ScaleResult> all;
  for (const float scale : scales(context)) all.push_back(measure(context, scale));
  ExperimentResult result;
  result.claims.push_back(claim_footprint(all));
  result.claims.push_back(claim_distance(all));
  result.blocks.emplace_back(table(all, kFootprint));
  result.blocks.emplace_back(table(all, kDistance));
  const AdaptedOptions o = options(context);
  result.setup = {{"Size", size_text(context)},
                  {"Scene", "cornell with 6 bounces, 0.055 to 550 m wide"},
                  {"Frames", fmt::format("{} sessions with separate seeds, {} frames before {} measured ones",
                                         o.sessions, o.warm_up, o.frames)},
                  {"Intervals", "95 %, from means of sessions; of blocks for path tracing"},
                  {"Reference", fmt::format("{} samples per pixel at each scale; its own noise is known and subtracted",
                                            context.choose(1024, 16))}};
  return result;
}

}  // namespace

Experiment scale_experiment() {
  return {"scale", kPaper, "joints of ReSTIR PT by footprint and by distance, at five scales of a scene", run_scale};
}

}  // namespace relume
