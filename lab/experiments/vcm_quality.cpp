// Vertex connection and merging against path tracing and bidirectional path tracing, where light reaches diffuse
// surfaces through water or glass and leaves them through it, too.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/estimate.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Georgiev12]";
constexpr const char* kOurs = "[relume]";
constexpr int kBounces = 8;
constexpr int kSide = 96;
constexpr int kReferenceSpp = 384;
constexpr double kLeastGain = 10;
constexpr double kMostTime = 1.6;         ///< frame time over that of bidirectional path tracing
constexpr double kMostDifference = 0.02;  ///< of mean luminances, relative
constexpr float kLargeLamp = 30;          ///< edge of the large lamp over that of the scene's, which is 15 cm

// Times per contender and repetition, in seconds. They bound the full run to about 22 minutes on two cores.
constexpr double kEqualTime_s = 4;
constexpr double kSchedules_s = 6;
constexpr double kLargeLamp_s = 10;  // path tracing is noisy behind glass
constexpr double kQuick_s = 1;       // before study() divides it

// Constant radii, each twice the one before. The first is the default, which then shrinks.
constexpr const char* kRadii[] = {"0.003", "0.006", "0.012", "0.024", "0.048"};
constexpr int kRadiusFrames = 24;
constexpr int kRadiusRepetitions = 4;

struct Case {
  std::string name;      ///< scene
  Rectangle region;      ///< seen through a smooth surface
  Rectangle elsewhere;   ///< region that bidirectional path tracing finds, too
  Comparison time;       ///< at equal time, against long rendering with vcm
  Comparison schedules;  ///< two schedules of the radius
  Comparison large;      ///< under a large lamp
};

StudyOptions options_of(const ExperimentContext& context, const std::string& techniques, double budget_s) {
  StudyOptions options{.techniques = techniques,
                       .budget_s = context.quick ? std::min(budget_s, kQuick_s) : budget_s,
                       .repetitions = 6,
                       .reference_spp = kReferenceSpp};
  use_square(context, kSide, options);
  options.reference = {{"estimator", "vcm"}, {"vcm.radius", "0.002"}, {"vcm.alpha", "0.75"}};
  return options;
}

constexpr const char* kAll = "path=estimator:path,bdpt=estimator:bdpt,vcm=estimator:vcm";
constexpr const char* kPathAndVcm = "path=estimator:path,vcm=estimator:vcm";
/// The first is the schedule of the reference.
constexpr const char* kSchedules =
    "narrow=estimator:vcm,vcm.radius:0.002,vcm.alpha:0.75,wide=estimator:vcm,vcm.radius:0.006,vcm.alpha:0.5";

Case measure(const ExperimentContext& context, const char* name, Rectangle region, Rectangle elsewhere) {
  const ExperimentScene scene = built_in(name, kBounces);
  StudyOptions large = options_of(context, kPathAndVcm, kLargeLamp_s);
  large.reference_spp = 2;  // means are compared with each other, not with it
  return {scene.name,
          std::move(region),
          std::move(elsewhere),
          study(context, scene, options_of(context, kAll, kEqualTime_s)),
          study(context, scene, options_of(context, kSchedules, kSchedules_s)),
          study(context, box_under_large_lamp(name, kLargeLamp, kBounces), large)};
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

/// "+0.12 % (-0.20 to +0.45)": deviation of the ratio from 1.
std::string deviation_text(const Ratio& ratio) {
  const auto percent = [](double r) { return 100 * (r - 1); };
  const std::string value = fmt::format("{:+.2f} %", percent(ratio.value));
  const Interval& interval = ratio.interval;
  if (!std::isfinite(interval.high)) return fmt::format("{} (at least {:+.2f})", value, percent(interval.low));
  return fmt::format("{} ({:+.2f} to {:+.2f})", value, percent(interval.low), percent(interval.high));
}

/// Mean luminances of two contenders in regions, which should be equal.
class Agreement {
 public:
  void add(const std::string& what, const Comparison& c, const char* a, const char* b, const Rectangle& region) {
    ratios_.push_back(error_ratio(region_means(c, a, region), region_means(c, b, region)));
    measured_ +=
        fmt::format("{}{}, {}: {}", measured_.empty() ? "" : "; ", what, region.name, deviation_text(ratios_.back()));
  }

  Claim claim(const char* id, const char* text) const {
    return judged_within(id, kOurs, text, measured_, "mean luminances within 2 % of each other", ratios_,
                         1 - kMostDifference, 1 + kMostDifference);
  }

 private:
  std::vector<Ratio> ratios_;
  std::string measured_;
};

/// Bias that does not vanish would differ between the schedules.
Claim claim_schedules(const std::vector<Case>& cases) {
  Agreement agreement;
  for (const Case& c : cases) agreement.add(c.name, c.schedules, "wide", "narrow", c.region);
  return agreement.claim("schedules", "Two schedules of the merging radius give the same image.");
}

Claim claim_large_lamp(const std::vector<Case>& cases) {
  Agreement agreement;
  for (const Case& c : cases) {
    for (const Rectangle& region : {c.region, Rectangle{"image"}})
      agreement.add(c.name, c.large, "vcm", "path", region);
  }
  return agreement.claim("large-lamp",
                         "Under a large lamp, which paths hit, the image is as bright as with path tracing.");
}

Claim claim_elsewhere(const std::vector<Case>& cases) {
  Agreement agreement;
  for (const Case& c : cases) agreement.add(c.name, c.time, "vcm", "bdpt", c.elsewhere);
  return agreement.claim("elsewhere",
                         "Where bidirectional path tracing finds all light, the image is as bright as its own.");
}

/// Ratio of frame times, with one value per repetition, in which both took turns.
Ratio cost_of(const Comparison& c) {
  const std::vector<double> bdpt = values_of(contender_named(c, "bdpt"), frame_ms);
  const std::vector<double> vcm = values_of(contender_named(c, "vcm"), frame_ms);
  std::vector<double> quotients;
  for (size_t i = 0; i < bdpt.size(); ++i) quotients.push_back(vcm[i] / bdpt[i]);
  return geometric_mean(quotients);
}

Claim claim_cost(const std::vector<Case>& cases) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const Case& c : cases) {
    ratios.push_back(cost_of(c.time));
    measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", c.name, share_text(ratios.back()));
  }
  return judged_within("cost", kOurs, "A frame takes at most 1.6 times as long as with bidirectional path tracing.",
                       measured, "ratio at most 1.6", ratios, 0, kMostTime);
}

/// Bias of a constant radius.
struct RadiusBias {
  const char* radius;
  Estimate bias2;
  Ratio brightness;  ///< of the region, over the reference's
};

/// The first two in a quick run.
std::span<const char* const> radii_of(const ExperimentContext& context) {
  return std::span(kRadii).first(static_cast<size_t>(context.choose(static_cast<int>(std::size(kRadii)), 2)));
}

std::vector<RadiusBias> biases_by_radius(const ExperimentContext& context, const Case& c) {
  const std::span<const char* const> radii = radii_of(context);
  std::string techniques;
  for (const char* radius : radii) {
    techniques +=
        fmt::format("{}{}=estimator:vcm,vcm.alpha:1,vcm.radius:{}", techniques.empty() ? "" : ",", radius, radius);
  }
  StudyOptions options = options_of(context, techniques, 0);
  options.spp = context.choose(kRadiusFrames, 4);
  options.repetitions = kRadiusRepetitions;
  const Comparison comparison = study(context, built_in(c.name, kBounces), options);
  const double truth = region_mean(comparison.reference.image, c.region);
  std::vector<RadiusBias> biases;
  for (const char* radius : radii) {
    std::vector<double> quotients = region_means(comparison, radius, c.region);
    for (double& q : quotients) q /= truth;
    biases.push_back({radius, region_bias2(comparison, radius, c.region), geometric_mean(quotients)});
  }
  return biases;
}

Claim claim_bias(const Case& c, const std::vector<RadiusBias>& biases) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (size_t i = 0; i < biases.size(); ++i) {
    measured += fmt::format("{}{}: {}", i > 0 ? ", " : "by radius: ", biases[i].radius, with_noise(biases[i].bias2));
    if (i > 0) verdicts.push_back(verdict_below(difference(biases[i - 1].bias2, biases[i].bias2)));
  }
  return with_verdict("bias-by-radius", "[Hachisuka12]",
                      fmt::format("{}: half the radius has less bias ({}).", c.name, c.region.name), measured,
                      "squared bias lower at every step beyond the noise (95 %)", verdict_of_all(verdicts));
}

TableBlock bias_table(const Case& c, const std::vector<RadiusBias>& biases) {
  TableBlock block{
      "Bias by radius",
      fmt::format("{}, {}, with a constant radius. The default starts at 0.003 and shrinks.", c.name, c.region.name),
      "radius",
      {{"squared bias"}, {"mean luminance over the reference's", "With 95 % interval."}},
      {}};
  for (const RadiusBias& b : biases) {
    block.rows.push_back({b.radius,
                          kNeutralColor,
                          {{with_noise(b.bias2), b.bias2.value}, {share_text(b.brightness), b.brightness.value}}});
  }
  return block;
}

ChartBlock bias_chart(const Case& c, const std::vector<RadiusBias>& biases) {
  ChartBlock block{"Bias by radius", "Squared bias with a constant radius. Bands are 95 % intervals.", {}};
  Chart chart{.label = "bias²", .x_label = "radius", .y_label = "bias²", .log_x = true, .log_y = true, .curves = {}};
  Curve curve{.name = c.name, .color = 0, .points = {}};
  for (const RadiusBias& b : biases) {
    if (b.bias2.value <= 0) continue;  // noise outweighs it
    const double noise = b.bias2.half_width();
    curve.points.push_back({std::stod(b.radius), b.bias2.value, std::max(b.bias2.value - noise, 1e-3 * b.bias2.value),
                            b.bias2.value + noise});
  }
  chart.curves.push_back(std::move(curve));
  block.charts.push_back(std::move(chart));
  return block;
}

void show(const Case& c, std::vector<Block>& blocks) {
  blocks.emplace_back(region_images(c.name + ", equal time", c.time, {c.region, c.elsewhere}));
  for (Block& block : study_blocks(c.name + ", equal time", c.time)) {
    if (!std::holds_alternative<ViewerBlock>(block)) blocks.push_back(std::move(block));
  }
}

ExperimentResult run_vcm_quality(const ExperimentContext& context) {
  std::vector<Case> cases;
  cases.push_back(measure(context, "cornell-water", {"below the water", 0.05, 0.78, 0.95, 0.96},
                          {"walls above the water", 0.05, 0.2, 0.95, 0.6}));
  cases.push_back(measure(context, "cornell-glass", {"floor through the clear sphere", 0.32, 0.56, 0.445, 0.64},
                          {"floor before the spheres", 0.1, 0.85, 0.9, 0.97}));
  const std::vector<RadiusBias> biases = biases_by_radius(context, cases[0]);
  ExperimentResult result;
  result.claims = {claim_gain(cases[0], "time-water"),
                   claim_gain(cases[1], "time-glass"),
                   claim_schedules(cases),
                   claim_large_lamp(cases),
                   claim_elsewhere(cases),
                   claim_bias(cases[0], biases),
                   claim_cost(cases)};
  result.blocks.emplace_back(bias_table(cases[0], biases));
  result.blocks.emplace_back(bias_chart(cases[0], biases));
  for (const Case& c : cases) show(c, result.blocks);
  result.setup = {
      {"Size", square_text(context, kSide)},
      {"Reference", fmt::format("{} samples of vcm, radius 0.002, alpha 0.75; under the large lamp, contenders are "
                                "compared with each other",
                                cases.front().time.reference.spp)},
      {"Bounces", fmt::format("{}, with roulette", kBounces)},
      {"Equal time", context.quick ? "0.025 s" : "4 s; 10 s under the large lamp, 6 s for each schedule"},
      {"Large lamp", "4.5 m × 4.5 m with the power of the scene's lamp, 15 cm × 15 cm"}};
  return result;
}

}  // namespace

Experiment vcm_quality_experiment() {
  return {"vcm-quality", kPaper, "vertex connection and merging below water and behind glass", run_vcm_quality};
}

}  // namespace relume
