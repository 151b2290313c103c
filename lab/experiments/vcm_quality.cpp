// Vertex connection and merging against path tracing and bidirectional path tracing, where light reaches diffuse
// surfaces through water or glass and leaves them through it, too.
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Georgiev12]";
constexpr const char* kOurs = "[relume]";
constexpr int kBounces = 8;
constexpr int kSide = 96;
constexpr int kReferenceSpp = 2048;
constexpr double kLeastGain = 10;
constexpr double kMostTime = 1.6;   ///< frame time over that of bidirectional path tracing
constexpr double kMostBias = 0.02;  ///< difference of two schedules of the radius

struct Case {
  std::string name;  ///< scene
  Rectangle region;  ///< seen through a smooth surface
  Comparison time;
  Comparison wide;  ///< another schedule of the radius, against the reference
  Ratio cost;       ///< frame time over that of bidirectional path tracing
};

StudyOptions options_of(const ExperimentContext& context, const std::string& techniques) {
  StudyOptions options{.techniques = techniques, .repetitions = 6, .reference_spp = kReferenceSpp};
  use_square(context, kSide, options);
  options.reference = {{"estimator", "vcm"}, {"vcm.radius", "0.002"}, {"vcm.alpha", "0.75"}};
  return options;
}

/// Ratio of frame times, with one value per repetition, in which both took turns.
Ratio cost_of(const Comparison& c) {
  const std::vector<double> bdpt = values_of(contender_named(c, "bdpt"), frame_ms);
  const std::vector<double> vcm = values_of(contender_named(c, "vcm"), frame_ms);
  std::vector<double> quotients;
  for (size_t i = 0; i < bdpt.size(); ++i) quotients.push_back(vcm[i] / bdpt[i]);
  return geometric_mean(quotients);
}

Case measure(const ExperimentContext& context, const char* name, Rectangle region) {
  const ExperimentScene scene = built_in(name, kBounces);
  StudyOptions time = options_of(context, "path=estimator:path,bdpt=estimator:bdpt,vcm=estimator:vcm");
  time.budget_s = 4;
  StudyOptions wide = options_of(context, "wide=estimator:vcm,vcm.radius:0.006,vcm.alpha:0.5");
  wide.spp = context.choose(256, 8);
  StudyOptions frames = options_of(context, "bdpt=estimator:bdpt,vcm=estimator:vcm");
  frames.spp = context.choose(16, 4);
  return {scene.name, std::move(region), study(context, scene, time), study(context, scene, wide),
          cost_of(study(context, scene, frames))};
}

Claim claim_gain(const Case& c, const std::string& id) {
  const Ratio path = region_ratio(c.time, "path", "vcm", c.region);
  const Ratio bdpt = region_ratio(c.time, "bdpt", "vcm", c.region);
  return judged_ratios(id, kPaper,
                       fmt::format("{}: at equal time, path tracing and bidirectional path tracing have at least {} "
                                   "times the MSE ({}).",
                                   c.name, kLeastGain, c.region.name),
                       fmt::format("path tracing {}, bidirectional {}", to_text(path), to_text(bdpt)), {path, bdpt},
                       kLeastGain);
}

/// Compares means of the region by two schedules: bias that does not vanish would differ.
Claim claim_schedules(const std::vector<Case>& cases) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (const Case& c : cases) {
    std::vector<double> differences;
    for (const Image& image : contender_named(c.wide, "wide").images)
      differences.push_back(region_mean(image, c.region) / region_mean(c.wide.reference.image, c.region) - 1);
    const Interval interval = mean_interval(differences);
    verdicts.push_back(verdict_of(interval, -kMostBias, kMostBias));
    measured += fmt::format("{}{}: {:+.2f} % ({:+.2f} to {:+.2f})", measured.empty() ? "" : ", ", c.name,
                            100 * mean(differences), 100 * interval.low, 100 * interval.high);
  }
  return with_verdict("schedules", kOurs, "Two schedules of the merging radius give the same image.", measured,
                      "means of the regions within 2 %, by the interval", verdict_of_all(verdicts));
}

Claim claim_cost(const std::vector<Case>& cases) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const Case& c : cases) {
    ratios.push_back(c.cost);
    measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", c.name, share_text(c.cost));
  }
  return judged_within("cost", kOurs, "A frame takes at most 1.6 times as long as with bidirectional path tracing.",
                       measured, "ratio at most 1.6", ratios, 0, kMostTime);
}

ExperimentResult run_vcm_quality(const ExperimentContext& context) {
  std::vector<Case> cases;
  cases.push_back(measure(context, "cornell-water", {"below the water", 0.05, 0.78, 0.95, 0.96}));
  cases.push_back(measure(context, "cornell-glass", {"floor through the clear sphere", 0.32, 0.56, 0.445, 0.64}));
  ExperimentResult result;
  result.claims = {claim_gain(cases[0], "time-water"), claim_gain(cases[1], "time-glass"), claim_schedules(cases),
                   claim_cost(cases)};
  for (const Case& c : cases) result.blocks.emplace_back(region_images(c.name + ", equal time", c.time, {c.region}));
  for (const Case& c : cases) {
    for (Block& block : study_blocks(c.name + ", equal time", c.time)) {
      if (!std::holds_alternative<ViewerBlock>(block)) result.blocks.push_back(std::move(block));
    }
  }
  result.setup = {
      {"Size", square_text(context, kSide)},
      {"Reference", fmt::format("{} samples of vcm, radius 0.002, alpha 0.75", cases.front().time.reference.spp)},
      {"Bounces", fmt::format("{}, with roulette", kBounces)},
      {"Equal time", context.quick ? "0.1 s" : "4 s"}};
  return result;
}

}  // namespace

Experiment vcm_quality_experiment() {
  return {"vcm-quality", kPaper, "vertex connection and merging below water and behind glass", run_vcm_quality};
}

}  // namespace relume
