// [Schipek22 §6.3]: measures the bounce at which cells terminate paths, and how radiance converges, in a corridor with
// its lamp behind three bends.
#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/all.h"
#include "experiments/measure/estimate.h"
#include "experiments/measure/frame_averages.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/references.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"
#include "render/session.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.3]";
constexpr float kConstants[] = {0, 0.1f, 1, 10, 100, 1000, 10000};
constexpr int kReferenceSpp = 2048;

RenderSettings settings_of(const ExperimentContext& context, const ExperimentScene& scene, CacheChoice cache) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  settings.cache = cache;
  settings.history = HistoryChoice::none;
  settings.apg.feed = kThesisFeed;
  return settings;
}

std::vector<FrameAverages> measure_depths(const ExperimentContext& context, const ExperimentScene& scene,
                                          const Reference& reference) {
  std::vector<FrameAverages> list;
  const PixelMask surfaces = surfaces_of(context, scene);
  const FramePlanOfAverages plan{
      .skip = context.choose(32, 8), .count = context.choose(32, 4), .repetitions = context.choose(8, 3)};
  for (const float constant : kConstants) {
    NamedSettings contender{fmt::format("{}", constant), settings_of(context, scene, CacheChoice::apg)};
    contender.settings.apg.variance_constant = constant;
    contender.settings.psf.grid.jitter = false;  // as in the thesis, to make the cells visible
    list.push_back(average_frames(context, scene, contender, plan, reference, surfaces));
  }
  return list;
}

Claim claim_depth(const std::vector<FrameAverages>& list) {
  std::vector<const char*> verdicts{verdict_below(difference(list.front().termination, list.back().termination))};
  std::string measured;
  for (size_t i = 0; i < list.size(); ++i) {
    measured += fmt::format("{}{}: {}", i > 0 ? ", " : "", list[i].name, with_noise(list[i].termination));
    if (i == 0) continue;
    const Estimate rise = difference(list[i].termination, list[i - 1].termination);
    verdicts.push_back(verdict_of({rise.value - rise.half_width(), rise.value + rise.half_width(), 0.95}, -0.005));
  }
  return with_verdict("depth", kPaper, "The mean depth at which paths end grows with the variance constant.",
                      "mean bounce by constant: " + measured, "monotone, to 0.005 of a bounce, by the interval",
                      verdict_of_all(verdicts));
}

/// Radiance and MSE: per frame of the first session; for all sessions, in the first frames and in the second half.
struct Arrival {
  std::string name;
  std::vector<double> share = {};  ///< mean radiance relative to the reference
  std::vector<double> mse = {};
  std::vector<double> first_share = {};  ///< per session: mean of the first four frames
  std::vector<double> later_share = {};  ///< mean of the second half of the frames
  std::vector<double> later_mse = {};
  Image first = {};
  Image last = {};
};

double mean_of_first(const std::vector<double>& values) {
  return mean({values.begin(), values.begin() + std::min<std::ptrdiff_t>(4, std::ssize(values) / 2)});
}

double mean_of_second_half(const std::vector<double>& values) {
  return mean({values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end()});
}

/// Frames of one session.
struct ArrivalRun {
  std::vector<double> share = {};
  std::vector<double> mse = {};
  Image first = {};
  Image last = {};
};
constexpr auto members_of(const ArrivalRun*) {
  return std::tuple(&ArrivalRun::share, &ArrivalRun::mse, &ArrivalRun::first, &ArrivalRun::last);
}

Arrival measure_arrival(const ExperimentContext& context, const ExperimentScene& scene, std::string name,
                        CacheChoice cache, const Reference& reference) {
  Session session(scene.scene, settings_of(context, scene, cache));
  session.set_camera(scene.camera);
  const auto measure = [&](const ExperimentContext& own, int seed) {
    session.restart(1 + seed);
    ArrivalRun run;
    for (int frame = 0; frame < own.choose(64, 6); ++frame) {
      own.check_stop();
      session.render_frame();
      run.last = session.image();
      if (frame == 0) run.first = run.last;
      const Metrics m = compute_metrics(run.last, reference.image, {.flip = false});
      run.share.push_back((m.mean_a[0] + m.mean_a[1] + m.mean_a[2]) / (m.mean_b[0] + m.mean_b[1] + m.mean_b[2]));
      run.mse.push_back(m.mse - reference.mse);
    }
    return run;
  };
  std::vector<ArrivalRun> runs = deal_parts(context, name, context.choose(6, 2), measure);
  Arrival result{std::move(name)};
  for (const ArrivalRun& run : runs) {
    result.first_share.push_back(mean_of_first(run.share));
    result.later_share.push_back(mean_of_second_half(run.share));
    result.later_mse.push_back(mean_of_second_half(run.mse));
  }
  result.share = std::move(runs.front().share);
  result.mse = std::move(runs.front().mse);
  result.first = std::move(runs.front().first);
  result.last = std::move(runs.front().last);
  return result;
}

Claim claim_arrival(const Arrival& graph) {
  const Ratio ratio = error_ratio(graph.first_share, graph.later_share);
  return judged_within(
      "arrival", kPaper,
      "Light propagates from cell to cell over several frames, so the first frames are too dark. (Here, a vertex with "
      "an unknown next cell waits for its path, so they should not be.)",
      fmt::format("{:.2f} of the reference's light in the first four frames, {:.2f} in the second half: {}",
                  mean(graph.first_share), mean(graph.later_share), share_text(ratio)),
      "first frames at most 0.8 of the later ones", {ratio}, 0, 0.8);
}

Claim claim_error(const Arrival& path, const Arrival& graph) {
  const Ratio ratio = error_ratio(graph.later_mse, path.later_mse);
  return judged_within("error", kPaper, "Once the light has propagated, apg+apsf has less error than path tracing.",
                       fmt::format("{:.3g} ({:.2g} to {:.2g}) of path tracing's MSE", ratio.value, ratio.interval.low,
                                   ratio.interval.high),
                       "at most 1", {ratio}, 0, 1);
}

ChartBlock depth_chart(const std::vector<FrameAverages>& list) {
  Curve curve{"apg", 0, false, {}};
  for (size_t i = 0; i < list.size(); ++i)
    curve.points.push_back({.x = std::max(1e-2, static_cast<double>(kConstants[i])), .y = list[i].termination.value});
  return {"Depth at which paths end",
          "Mean over pixels and frames of the bounce, from 1, after which a path no longer contributes. The leftmost "
          "point is the constant 0. Jitter is off.",
          {{"by constant", "variance constant", "bounce", true, false, {curve}}}};
}

ChartBlock arrival_chart(const std::vector<Arrival>& list) {
  Chart share{"light", "frame", "mean radiance over the reference's", false, false, {}};
  Chart error{"error", "frame", "MSE", true, true, {}};
  for (size_t i = 0; i < list.size(); ++i) {
    Curve curve{list[i].name, static_cast<int>(i), false, {}};
    for (size_t k = 0; k < list[i].share.size(); ++k)
      curve.points.push_back({.x = static_cast<double>(k + 1), .y = list[i].share[k]});
    share.curves.push_back(curve);
    for (size_t k = 0; k < curve.points.size(); ++k) curve.points[k].y = std::max(1e-9, list[i].mse[k]);
    error.curves.push_back(std::move(curve));
  }
  return {"Frame by frame",
          "One sample per pixel, without a history except the cells'.",
          {std::move(share), std::move(error)}};
}

ViewerBlock images(const std::vector<Arrival>& list, const Image& reference) {
  const ImageOptions options{.tone_map = ToneMap::agx, .exposure = 0, .values = false};
  ImageSet set{.label = "corridor", .width = reference.width, .height = reference.height, .images = {}, .crops = {}};
  set.images.push_back(plain_image("reference", kNeutralColor, reference, options));
  for (size_t i = 0; i < list.size(); ++i) {
    const int color = static_cast<int>(i);
    set.images.push_back(measured_image(list[i].name + ", first", color, list[i].first, reference, options));
    set.images.push_back(measured_image(list[i].name + ", last", color, list[i].last, reference, options));
  }
  return {"Images", "The first and the last frame.", image_layer_kinds(), {std::move(set)}};
}

ExperimentResult run_apg_depth(const ExperimentContext& context) {
  const ExperimentScene corridor = built_in("corridor", 10);
  const Reference reference = make_reference(context, corridor, context.choose(kReferenceSpp, 16));
  const std::vector<FrameAverages> depths = measure_depths(context, corridor, reference);
  const std::vector<Arrival> arrivals{measure_arrival(context, corridor, "path", CacheChoice::none, reference),
                                      measure_arrival(context, corridor, "psf", CacheChoice::psf, reference),
                                      measure_arrival(context, corridor, "apg", CacheChoice::apg, reference),
                                      measure_arrival(context, corridor, "apg+apsf", CacheChoice::apsf_apg, reference)};
  ExperimentResult result;
  result.claims = {claim_depth(depths), claim_arrival(arrivals[2]), claim_error(arrivals[0], arrivals[3])};
  result.blocks = {depth_chart(depths), arrival_chart(arrivals), images(arrivals, reference.image)};
  result.setup = {{"Scene", "corridor, 10 bounces"},
                  common_setup(context).front(),
                  {"Reference", fmt::format("{} samples", context.choose(kReferenceSpp, 16))},
                  {"Settings", "apg.feed 1, as in the thesis"}};
  return result;
}

}  // namespace

Experiment apg_depth_experiment() {
  return {"apg-depth", kPaper, "depth at which cells end paths, in a corridor with a distant lamp", run_apg_depth};
}

}  // namespace relume
