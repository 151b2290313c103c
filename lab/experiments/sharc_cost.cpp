// [Sharc25]: error, frame time and bias of the spatially hashed radiance cache, against path graphs: update paths of
// few pixels, ends of paths by the size of cells, and cells of all depths.
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/estimate.h"
#include "experiments/measure/frame_averages.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/apply_settings.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "metrics/estimate.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sharc25]";
constexpr const char* kOurs = "[relume]";

/// As many as update paths have at least: cells hold light of more bounces than shorter paths would.
constexpr int kBounces = 16;
constexpr double kMostSparse = 1.1;  ///< MSE with 4 % of the update paths over that with all

struct Technique {
  const char* name;
  const char* settings;
};

/// For errors and times. The first is path tracing.
constexpr Technique kContenders[] = {
    {"path", "cache:none"},
    {"apg", "cache:apg"},
    {"apsf+apg", "cache:apsf+apg"},
    {"sharc", "cache:sharc"},
    {"sharc, all pixels update", "cache:sharc,sharc.update:all"},
    {"sharc, ends by variance", "cache:sharc,sharc.end:variance"},
};

/// For bias: cells of sharc.cell-size 16 are as large as those of apg behind the first vertex.
constexpr Technique kOfEqualCells[] = {
    {"apg", "cache:apg"},
    {"apsf+apg", "cache:apsf+apg"},
    {"sharc, 16 px", "cache:sharc,sharc.cell-size:16"},
    {"sharc, 16 px, ends by variance", "cache:sharc,sharc.cell-size:16,sharc.end:variance"},
};

struct SceneResult {
  std::string name;
  std::vector<AdaptedError> frames;
  std::vector<FrameAverages> averages;
  ImageSet images;

  const AdaptedError& of(std::string_view name_of_technique) const {
    return named(frames, "contender", name_of_technique);
  }
  const FrameAverages& average_of(std::string_view name_of_technique) const {
    return named(averages, "cache", name_of_technique);
  }
};

/// Cells reach their history of 32 frames within the warm-up. A session is one value.
AdaptedOptions options(const ExperimentContext& context) {
  return {.warm_up = context.choose(48, 4),
          .frames = context.choose(24, 2),
          .sessions = context.choose(4, 2),
          .block = context.choose(24, 2)};
}

FramePlanOfAverages plan(const ExperimentContext& context) {
  return {.skip = context.choose(48, 2), .count = context.choose(64, 4), .repetitions = context.choose(5, 3)};
}

std::vector<ExperimentScene> scenes(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{at_rest(built_in("cornell", kBounces))};
  if (!context.quick) {
    for (const char* name : {"corridor", "mine", "warehouse"}) list.push_back(at_rest(built_in(name, kBounces)));
  }
  if (std::optional<ExperimentScene> hall = sponza(context)) {
    hall->settings.path.max_bounces = kBounces;
    list.push_back(std::move(*hall));
  }
  return list;
}

NamedSettings contender(const ExperimentContext& context, const ExperimentScene& scene, const Technique& technique) {
  NamedSettings result{technique.name, scene.settings};
  set_size_and_device(context, result.settings, scene.scale);
  result.settings.history = HistoryChoice::none;
  apply_settings(technique.settings, technique.name, result.settings);
  return result;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, plainly_sampled(scene));
  const PixelMask surfaces = surfaces_of(context, scene);
  std::vector<NamedSettings> contenders;
  for (const Technique& technique : kContenders) contenders.push_back(contender(context, scene, technique));
  SceneResult result{scene.name, {}, {}, {}};
  result.frames = measure_adapted(context, scene, contenders, reference, {surfaces}, options(context));
  for (const Technique& technique : kOfEqualCells) {
    result.averages.push_back(
        average_frames(context, scene, contender(context, scene, technique), plan(context), reference, surfaces));
  }
  result.images = adapted_images(scene.name, result.frames, reference.image);
  return result;
}

Claim claim_update(const std::vector<SceneResult>& list) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const SceneResult& scene : list) {
    ratios.push_back(error_ratio(scene.of("sharc").mse[0], scene.of("sharc, all pixels update").mse[0]));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, share_text(ratios.back()));
  }
  return judged_within("update", kPaper,
                       "Update paths of 4 % of the pixels suffice: those of all pixels lower the MSE of "
                       "a frame by at most a tenth.",
                       "4 % over all: " + measured, fmt::format("at most {} in each scene", kMostSparse), ratios, 0,
                       kMostSparse);
}

Claim claim_time(const std::vector<SceneResult>& list, const char* id, const char* other) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const SceneResult& scene : list) {
    ratios.push_back(time_ratio(scene.of("sharc"), scene.of(other)));
    measured += fmt::format("{}{} {} ({:.1f} rays per pixel against {:.1f})", measured.empty() ? "" : "; ", scene.name,
                            share_text(ratios.back()), scene.of("sharc").rays, scene.of(other).rays);
  }
  return judged_within(id, kOurs, fmt::format("A frame with sharc takes less time than with {}.", other), measured,
                       "ratio below 1 in each scene", ratios, 0, 1);
}

std::string bias_text(const std::string& scene) {
  return scene + ": with cells of equal size, sharc has no more bias than apg.";
}
std::string variance_text(const std::string& scene) {
  return scene + ": paths that only end where samples of a cell vary little have less bias.";
}
constexpr const char* kNoMore = "below 1.05 times apg's beyond the noise";
constexpr const char* kLess = "a difference beyond the noise (95 %)";

std::string biases_text(const FrameAverages& a, const FrameAverages& b) {
  return fmt::format("bias² {} against {} of {}; variance {} against {}", with_noise(a.bias2), with_noise(b.bias2),
                     b.name, with_noise(a.variance), with_noise(b.variance));
}

Claim claim_bias(const SceneResult& scene, const std::string& id) {
  const FrameAverages& own = scene.average_of("sharc, 16 px");
  const FrameAverages& graph = scene.average_of("apg");
  return with_verdict("bias-" + id, kOurs, bias_text(scene.name), biases_text(own, graph), kNoMore,
                      verdict_below(difference(own.bias2, scaled(graph.bias2, 1.05))));
}

Claim claim_variance(const SceneResult& scene, const std::string& id) {
  const FrameAverages& careful = scene.average_of("sharc, 16 px, ends by variance");
  const FrameAverages& all = scene.average_of("sharc, 16 px");
  return with_verdict("variance-" + id, kOurs, variance_text(scene.name), biases_text(careful, all), kLess,
                      verdict_below(difference(careful.bias2, all.bias2)));
}

TableBlock frame_table(const SceneResult& scene) {
  TableBlock block{scene.name,
                   "One sample per pixel, adapted: MSE where no lamp is visible, times and rays of a frame, and MSE "
                   "times time, path tracing's over the technique's.",
                   "technique",
                   {{"MSE", "", Better::lower},
                    {"ms per frame", "", Better::lower},
                    {"time over path tracing's", "", Better::lower},
                    {"rays per pixel", "", Better::lower},
                    {"times lower, times time", "", Better::higher}},
                   {}};
  int color = 0;
  for (const AdaptedError& e : scene.frames) {
    const Ratio time = time_ratio(e, scene.of("path"));
    const Ratio gain = equal_time_ratio(scene.of("path"), e);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {share_text(time), time.value},
                           {fmt::format("{:.2f}", e.rays), e.rays},
                           {to_text(gain), gain.value}}});
  }
  return block;
}

TableBlock bias_table(const std::vector<SceneResult>& list) {
  TableBlock block{"Bias with cells of equal size",
                   "Squared bias of the average of many frames, with half the 95 % interval; below, the variance of a "
                   "frame.",
                   "technique",
                   {},
                   {}};
  for (const SceneResult& scene : list) block.columns.push_back({scene.name, "", Better::lower});
  for (size_t i = 0; i < list.front().averages.size(); ++i) {
    TableRow row{.name = list.front().averages[i].name, .color = static_cast<int>(i), .cells = {}};
    for (const SceneResult& scene : list) {
      const FrameAverages& a = scene.averages[i];
      row.cells.push_back({with_noise(a.bias2), a.bias2.value, "variance " + with_noise(a.variance)});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

/// "corridor", "sponza".
std::string id_of(const SceneResult& scene) { return scene.name == "Sponza" ? "sponza" : scene.name; }

std::vector<std::pair<std::string, std::string>> setup(const ExperimentContext& context) {
  const AdaptedOptions o = options(context);
  const FramePlanOfAverages p = plan(context);
  return {
      {"Size", size_text(context)},
      {"Bounces", fmt::format("{}, with roulette", kBounces)},
      {"Frames", fmt::format("{} sessions with separate seeds, {} frames before {} measured ones; path tracing uses "
                             "one session",
                             o.sessions, o.warm_up, o.frames)},
      {"Averages", fmt::format("{} repetitions of {} frames after {} others", p.repetitions, p.count, p.skip)},
      {"Times", "contenders take turns frame by frame"},
      {"Reference", fmt::format("{} samples per pixel with the light tree; its own noise is known and subtracted",
                                context.choose(1024, 16))}};
}

ExperimentResult run_sharc_cost(const ExperimentContext& context) {
  std::vector<SceneResult> results;
  for (const ExperimentScene& scene : scenes(context)) results.push_back(measure(context, scene));
  ExperimentResult result;
  result.claims.push_back(claim_update(results));
  result.claims.push_back(claim_time(results, "time-apg", "apg"));
  result.claims.push_back(claim_time(results, "time-apsf-apg", "apsf+apg"));
  for (const SceneResult& scene : results) {
    result.claims.push_back(claim_bias(scene, id_of(scene)));
    result.claims.push_back(claim_variance(scene, id_of(scene)));
  }
  claim_without_sponza(
      context, kOurs,
      {{"bias-sponza", bias_text("Sponza"), kNoMore}, {"variance-sponza", variance_text("Sponza"), kLess}},
      result.claims);
  std::vector<ImageSet> images;
  for (SceneResult& scene : results) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : results) result.blocks.emplace_back(frame_table(scene));
  result.blocks.emplace_back(bias_table(results));
  result.setup = setup(context);
  return result;
}

}  // namespace

Experiment sharc_cost_experiment() {
  return {"sharc-cost", kPaper, "sparse updates, frame times and bias of the spatially hashed cache", run_sharc_cost};
}

}  // namespace relume
