// [Bitterli20, Lin22]: bias of the modes of ReSTIR DI, over seeds: in whole images, and along edges of depth and of
// shadows, where neighbours and earlier frames see other lamps.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/edges.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "experiments/shared_parts.h"
#include "metrics/ensemble.h"
#include "metrics/statistics.h"
#include "render/session.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Bitterli20, Lin22]";
constexpr const char* kOurs = "[relume]";
constexpr float kFrameStep_s = 1.0f / 24;
constexpr float kAside_m = 0.3f;    ///< motion of the camera before the measured frames
constexpr double kMostBias = 0.01;  ///< of the mean of an image or of all edges
/// With 32 runs, chance exceeds it once in 50,000 blocks.
constexpr double kMostSignificance = 5;

struct Mode {
  const char* name;
  const char* json;
  bool moving = false;  ///< measured with moving geometry, too
};

constexpr Mode kModes[] = {
    {"ris", R"({"reuse": "ris"})", true},
    {"exact", R"({"reuse": "restir-di"})", true},
    {"exact, frames only", R"({"reuse": "restir-di", "restir.neighbours": 0})"},
    {"exact, pixels only", R"({"reuse": "restir-di", "restir.cap": 0})"},
    {"exact, temporal feedback", R"({"reuse": "restir-di", "restir.feedback": "temporal"})"},
    {"lagging", R"({"reuse": "restir-di", "restir.correction": "lagging"})", true},
    {"lagging, frames only", R"({"reuse": "restir-di", "restir.correction": "lagging", "restir.neighbours": 0})", true},
    {"basic", R"({"reuse": "restir-di", "restir.correction": "basic"})", true},
    {"basic, frames only", R"({"reuse": "restir-di", "restir.correction": "basic", "restir.neighbours": 0})"},
    {"basic, pixels only", R"({"reuse": "restir-di", "restir.correction": "basic", "restir.cap": 0})"},
};

/// Biases of a mode.
struct ModeBias {
  std::string name;
  BlockBias image;
  BlockBias depth;   ///< pixels along edges of depth
  BlockBias shadow;  ///< pixels along edges of shadows
  double worst = 0;  ///< largest significance of a block along either
  size_t blocks = 0;
  ErrorSplit split;
  Image mean;
};

struct SceneResult {
  std::string name;
  Reference reference;
  std::vector<ModeBias> modes;

  const ModeBias& of(std::string_view mode) const { return named(modes, "mode", mode); }
};

/// A box that moves sideways by 0.05 m per frame below a lamp: surfaces that its shadow enters and leaves, and faces
/// that advance.
ExperimentScene moving_box() {
  ExperimentScene scene = at_rest(built_in("cornell", 1));
  scene.name = "moving box";
  const Node& box = named(scene.scene.nodes, "node", "tall box");
  const auto node = static_cast<Index>(&box - scene.scene.nodes.data());
  const Vec3 from = box.transform.translation;
  const float seconds = 1;
  scene.scene.animation = {{node,
                            AnimatedProperty::translation,
                            Interpolation::linear,
                            {0, seconds},
                            {Vec4(from, 0), Vec4(from + Vec3(1.2f * seconds, 0, 0), 0)}}};
  return scene;
}

int frames_in(const ExperimentContext& context) { return context.choose(16, 4); }

/// Renders the frames of one run. The last is the image, or with a still scene the mean of a quarter of them after the
/// camera has come to rest.
Image render_run(const ExperimentContext& context, const ExperimentScene& scene, Session& session, int seed,
                 bool moving) {
  const int frames = frames_in(context);
  session.set_time(0);
  session.set_camera(scene.camera);
  session.restart(seed);
  for (int i = 0; i < frames; ++i) {
    context.check_stop();
    if (moving) {
      session.set_time(kFrameStep_s * static_cast<float>(i));
    } else {
      const int steps = std::max(frames - frames / 4 - i, 0);  // until the camera rests
      session.set_camera(turned_aside(scene, 0, -kAside_m * static_cast<float>(steps) / static_cast<float>(frames)));
    }
    session.render_frame();
  }
  return session.image();
}

/// Values that summarise the runs of a mode.
ModeBias bias_of(const Mode& mode, const std::vector<Image>& runs, const Reference& reference) {
  ModeBias result{.name = mode.name, .image = {}, .depth = {}, .shadow = {}, .split = {}, .mean = {}};
  const PixelMask all = mask_of({"image"}, reference.image.width, reference.image.height);
  const PixelMask depth = depth_edges(reference);
  const PixelMask shadow = shadow_edges(reference);
  result.image = block_bias(runs, reference, pixels_in(all));
  result.depth = block_bias(runs, reference, pixels_in(depth));
  result.shadow = block_bias(runs, reference, pixels_in(shadow));
  for (const PixelMask* edges : {&depth, &shadow}) {
    for (const EdgeBlock& block : blocks_of(*edges, reference.image.width, reference.image.height, 8, 6)) {
      const BlockBias bias = block_bias(runs, reference, block.pixels);
      ++result.blocks;
      if (std::fabs(bias.significance()) > std::fabs(result.worst)) result.worst = bias.significance();
    }
  }
  Ensemble ensemble;
  for (const Image& run : runs) ensemble.add(run);
  result.split = ensemble.split(reference.image, reference.mse);
  result.mean = ensemble.mean();
  return result;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene, bool moving) {
  ExperimentScene last = plainly_sampled(scene);
  if (moving) last.settings.time_s = kFrameStep_s * static_cast<float>(frames_in(context) - 1);
  SceneResult result{scene.name, make_reference(context, last, context.choose(2048, 16)), {}};
  RenderSettings base = scene.settings;
  set_size_and_device(context, base, scene.scale);
  base.history = moving ? HistoryChoice::none : HistoryChoice::accumulate;
  Session session(Scene(scene.scene), base);
  for (const Mode& mode : kModes) {
    if (moving && !mode.moving) continue;
    RenderSettings settings = base;
    settings_from_json(describe(settings), mode.json, mode.name);
    session.set_settings(settings);
    const std::vector<Image> runs = deal_parts(
        context, fmt::format("{}, {}", scene.name, mode.name), context.choose(32, 3),
        [&](const ExperimentContext& own, int run) { return render_run(own, scene, session, 1 + run, moving); });
    result.modes.push_back(bias_of(mode, runs, result.reference));
  }
  return result;
}

/// Interval of the bias relative to the reference, by the normal distribution.
Interval relative_interval(const BlockBias& bias) {
  const double middle = bias.reference > 0 ? bias.bias / bias.reference : 0;
  const double half = bias.reference > 0 ? 1.96 * bias.error / bias.reference : 0;
  return {middle - half, middle + half, 0.95};
}

/// Verdict on whether the relative bias is in [least, most]. Undecided without light, as where no edge is visible.
const char* verdict_on(const BlockBias& bias, double least, double most) {
  return bias.reference > 0 ? verdict_of(relative_interval(bias), least, most) : kVerdictUndecided;
}

/// "−1.2 % ± 0.3 %".
std::string bias_text(const BlockBias& bias) {
  const Interval interval = relative_interval(bias);
  return fmt::format("{:+.2f} % ± {:.2f}", 50 * (interval.low + interval.high), 50 * (interval.high - interval.low));
}

std::string id_of(const char* prefix, const SceneResult& scene) {
  return fmt::format("{}-{}", prefix, scene.name == "moving box" ? "moving" : scene.name);
}

/// Claims that each mode of the list has the mean of the reference.
Claim claim_unbiased(const SceneResult& scene, const char* id, const char* paper, const std::string& text,
                     const std::vector<const ModeBias*>& modes) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (const ModeBias* mode : modes) {
    for (const BlockBias* bias : {&mode->image, &mode->depth, &mode->shadow})
      verdicts.push_back(verdict_on(*bias, -kMostBias, kMostBias));
    verdicts.push_back(std::fabs(mode->worst) < kMostSignificance ? kVerdictHolds : kVerdictFails);
    measured += fmt::format("{}{}: image {}, depth edges {}, shadow edges {}; worst of {} blocks {:.1f} σ",
                            measured.empty() ? "" : "; ", mode->name, bias_text(mode->image), bias_text(mode->depth),
                            bias_text(mode->shadow), mode->blocks, std::fabs(mode->worst));
  }
  return with_verdict(id_of(id, scene), paper, text, measured,
                      "image and edges within 1 %, by the interval; each block along edges within 5 standard errors",
                      verdict_of_all(verdicts));
}

std::vector<const ModeBias*> modes_named(const SceneResult& scene, std::string_view prefix) {
  std::vector<const ModeBias*> list;
  for (const ModeBias& mode : scene.modes) {
    if (std::string_view(mode.name).starts_with(prefix)) list.push_back(&mode);
  }
  return list;
}

/// Claims that the mode loses light along shadow edges, beyond the noise, and more than in the whole image.
Claim claim_basic(const SceneResult& scene) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (const ModeBias* mode : modes_named(scene, "basic")) {
    measured += fmt::format("{}{}: image {}, depth edges {}, shadow edges {}", measured.empty() ? "" : "; ", mode->name,
                            bias_text(mode->image), bias_text(mode->depth), bias_text(mode->shadow));
    if (mode->name == "basic") verdicts.push_back(verdict_on(mode->shadow, -1, 0));
  }
  return with_verdict(id_of("basic", scene), "[Bitterli20]",
                      scene.name + ": without rays in the weights, the image loses energy along shadows.", measured,
                      "below 0 along shadow edges, by the interval", verdict_of_all(verdicts));
}

Claim claim_lagging(const SceneResult& scene) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (const ModeBias* mode : modes_named(scene, "lagging")) {
    verdicts.push_back(verdict_on(mode->image, -0.02, 0.02));
    measured += fmt::format("{}{}: image {}, depth edges {}, shadow edges {}, bias² {:.2e} of {:.2e}",
                            measured.empty() ? "" : "; ", mode->name, bias_text(mode->image), bias_text(mode->depth),
                            bias_text(mode->shadow), mode->split.bias2, mode->split.bias2 + mode->split.variance);
  }
  return with_verdict("lagging-moving", kOurs,
                      "Where geometry moves, keeping reservoirs changes the mean of the image by at most 2 %.",
                      measured, "image within 2 %, by the interval", verdict_of_all(verdicts));
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{
      scene.name,
      "Mean over the runs against path tracing, with 95 % intervals from the runs and from the reference's "
      "noise. Edges of depth and of shadows: pixels beside them. Blocks: 8 × 8 pixels, with at least 6 "
      "along an edge. Bias² and variance are of one run.",
      "mode",
      {{"image", "", Better::none},
       {"depth edges", "", Better::none},
       {"shadow edges", "", Better::none},
       {"worst block, σ", "", Better::lower},
       {"bias²", "", Better::lower},
       {"variance", "", Better::lower}},
      {}};
  int color = 0;
  for (const ModeBias& mode : scene.modes) {
    const auto cell = [](const BlockBias& bias) {
      return TableCell{bias_text(bias), bias.reference > 0 ? bias.bias / bias.reference : 0.0};
    };
    block.rows.push_back({mode.name,
                          color++,
                          {cell(mode.image),
                           cell(mode.depth),
                           cell(mode.shadow),
                           {fmt::format("{:+.1f}", mode.worst), std::fabs(mode.worst)},
                           {fmt::format("{:.2e}", mode.split.bias2), mode.split.bias2},
                           {fmt::format("{:.2e}", mode.split.variance), mode.split.variance}}});
  }
  return block;
}

ImageSet images(const SceneResult& scene) {
  std::vector<MeasuredImage> list;
  int color = 0;
  for (const ModeBias& mode : scene.modes)
    list.push_back({mode.name, color++, &mode.mean, "image " + bias_text(mode.image)});
  return measured_set(scene.name, scene.reference.image, list, {.values = false});
}

ExperimentResult run_restir_bias(const ExperimentContext& context) {
  ExperimentScene warehouse = learning_scene("warehouse");
  warehouse.settings.path.max_bounces = 1;
  warehouse.settings.lights = LightSelectionChoice::light_tree;
  std::vector<SceneResult> scenes;
  scenes.push_back(measure(context, warehouse, false));
  scenes.push_back(measure(context, at_rest(built_in("cornell", 1)), false));
  scenes.push_back(measure(context, moving_box(), true));
  ExperimentResult result;
  for (const SceneResult& scene : scenes) {
    result.claims.push_back(claim_unbiased(
        scene, "exact", kPaper, scene.name + ": with rays in the weights, reuse is unbiased, also along edges.",
        modes_named(scene, "exact")));
    if (scene.name == "moving box") continue;
    result.claims.push_back(claim_unbiased(scene, "lagging", kOurs,
                                           scene.name + ": keeping reservoirs is unbiased where no geometry moves.",
                                           modes_named(scene, "lagging")));
  }
  result.claims.push_back(claim_lagging(scenes.back()));
  for (const SceneResult& scene : scenes) result.claims.push_back(claim_basic(scene));
  std::vector<ImageSet> sets;
  for (const SceneResult& scene : scenes) {
    result.blocks.emplace_back(table(scene));
    sets.push_back(images(scene));
  }
  result.blocks.emplace_back(
      ViewerBlock{"Images", "Means over all runs; their maps show the bias.", image_layer_kinds(), std::move(sets)});
  result.setup = {
      {"Size", size_text(context)},
      {"Light", "direct; in `warehouse`, candidates of reservoirs come from the light tree"},
      {"Runs", fmt::format("{} seeds, {} frames each", context.choose(32, 3), frames_in(context))},
      {"Still scenes", "the camera moves aside until it rests for a quarter of the frames, whose mean is measured"},
      {"Moving box", "the tall box of `cornell` moves by 0.05 m per frame; the last frame is measured"},
      {"Reference", fmt::format("{} samples per pixel with the light tree; its noise is in the intervals",
                                context.choose(2048, 16))}};
  return result;
}

}  // namespace

Experiment restir_bias_experiment() {
  return {"restir-bias", kPaper, "bias of reused reservoirs over seeds, along edges of depth and of shadows",
          run_restir_bias};
}

}  // namespace relume
