// [Sun20]: caustics at equal time, by bidirectional path tracing with and without a layer of its own for the denoiser,
// by vertex connection and merging, and by today's unidirectional techniques.
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "experiments/measure/study.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sun20 §5.1]";
constexpr const char* kMergingPaper = "[Georgiev12]";
constexpr const char* kOurs = "[relume]";
constexpr int kBounces = 8;
constexpr int kSide = 96;
constexpr int kReferenceSpp = 384;
constexpr double kEqualTime_s = 4;
constexpr double kQuickTime_s = 1;  ///< replaces it in quick runs, where study() divides times by 40
constexpr double kLeastGain = 5;    ///< of bidirectional over unidirectional path tracing in a caustic
constexpr double kMostMerging = 2;  ///< MSE of merging over that of bidirectional path tracing in a caustic

struct Technique {
  const char* name;
  const char* settings;
  bool unbiased = false;
};

constexpr Technique kTechniques[] = {
    {"path", "estimator:path", true},
    {"bdpt", "estimator:bdpt", true},
    {"mcpg", "guide:mcpg", true},
    {"restir-pt", "reuse:restir-pt", true},
    {"vcm", "estimator:vcm"},
    {"bdpt-svgf", "estimator:bdpt,denoise:svgf"},
    {"caustic-layer", "estimator:bdpt,denoise:svgf,bdpt.caustic-layer:true"},
};

struct Case {
  std::string name;   ///< scene
  std::string id;     ///< of claims
  Rectangle caustic;  ///< seen directly
  Rectangle behind;   ///< lit and seen through a smooth surface
  Comparison time;
};

StudyOptions options_of(const ExperimentContext& context) {
  StudyOptions options{.techniques = {},
                       .budget_s = context.quick ? kQuickTime_s : kEqualTime_s,
                       .repetitions = 6,
                       .reference_spp = kReferenceSpp};
  for (const Technique& technique : kTechniques) {
    options.techniques +=
        fmt::format("{}{}={}", options.techniques.empty() ? "" : ",", technique.name, technique.settings);
  }
  use_square(context, kSide, options);
  options.reference = {{"estimator", "vcm"}, {"vcm.radius", "0.002"}, {"vcm.alpha", "0.75"}};
  return options;
}

Case measure(const ExperimentContext& context, const char* name, const char* id, Rectangle caustic, Rectangle behind) {
  return {name, id, std::move(caustic), std::move(behind),
          study(context, built_in(name, kBounces), options_of(context))};
}

Claim claim_gain(const Case& c) {
  const Ratio ratio = region_ratio(c.time, "path", "bdpt", c.caustic);
  return judged_ratios(
      "path-" + c.id, kPaper,
      fmt::format("{}: at equal time, path tracing has at least {} times the MSE of bidirectional path "
                  "tracing ({}).",
                  c.name, kLeastGain, c.caustic.name),
      to_text(ratio), {ratio}, kLeastGain);
}

/// Claim that every other unbiased technique, or every other technique at all, has more error than one.
Claim claim_least(const Case& c, const std::string& id, const char* paper, const std::string& text,
                  std::string_view winner, const Rectangle& region, bool unbiased_only) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const Technique& technique : kTechniques) {
    if (technique.name == winner || (unbiased_only && !technique.unbiased)) continue;
    ratios.push_back(region_ratio(c.time, technique.name, winner, region));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : "; ", technique.name, to_text(ratios.back()));
  }
  return judged_ratios(id, paper, text, measured + " of its MSE", ratios, 1);
}

Claim claim_first(const Case& c) {
  return claim_least(
      c, "first-" + c.id, kOurs,
      fmt::format("{}: at equal time, no other unbiased technique has less error than bidirectional path tracing ({}).",
                  c.name, c.caustic.name),
      "bdpt", c.caustic, true);
}

Claim claim_behind(const Case& c) {
  return claim_least(
      c, "behind-" + c.id, kMergingPaper,
      fmt::format("{}: at equal time, no technique has less error than merging ({}).", c.name, c.behind.name), "vcm",
      c.behind, false);
}

Claim claim_merging(const Case& c) {
  const Ratio ratio = region_ratio(c.time, "vcm", "bdpt", c.caustic);
  return judged_within("merging-" + c.id, kOurs,
                       fmt::format("{}: merging costs at most a factor of {} where bidirectional path tracing finds "
                                   "all light ({}).",
                                   c.name, kMostMerging, c.caustic.name),
                       share_text(ratio) + " of its MSE at equal time", fmt::format("at most {}", kMostMerging),
                       {ratio}, 0, kMostMerging);
}

Claim claim_layer(const Case& c) {
  const Ratio ratio = region_ratio(c.time, "bdpt-svgf", "caustic-layer", c.caustic);
  return judged_ratios(
      "layer-" + c.id, kOurs,
      fmt::format("{}: denoised apart from other light, caustics have less error ({}).", c.name, c.caustic.name),
      "denoised together " + to_text(ratio) + " of the MSE", {ratio}, 1);
}

TableBlock table(const std::vector<Case>& cases) {
  TableBlock block{"MSE by region",
                   "At equal time, against the reference, whose own noise is subtracted. Below: how many times lower "
                   "than path tracing's. Errors of denoisers include their blur.",
                   "technique",
                   {},
                   {}};
  for (const Case& c : cases) {
    for (const Rectangle* region : {&c.caustic, &c.behind})
      block.columns.push_back({fmt::format("{}, {}", c.name, region->name), "", Better::lower});
  }
  int color = 0;
  for (const Technique& technique : kTechniques) {
    TableRow row{.name = technique.name, .color = color++, .cells = {}};
    for (const Case& c : cases) {
      for (const Rectangle* region : {&c.caustic, &c.behind}) {
        const double error = mean(region_errors(c.time, technique.name, *region));
        const Ratio gain = region_ratio(c.time, "path", technique.name, *region);
        row.cells.push_back({fmt::format("{:.3e}", error), error, to_text(gain)});
      }
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

void show(const Case& c, std::vector<Block>& blocks) {
  blocks.emplace_back(region_images(c.name + ", equal time", c.time, {c.caustic, c.behind}));
  for (Block& block : study_blocks(c.name + ", equal time", c.time)) {
    if (!std::holds_alternative<ViewerBlock>(block)) blocks.push_back(std::move(block));
  }
}

ExperimentResult run_caustics(const ExperimentContext& context) {
  std::vector<Case> cases;
  cases.push_back(measure(context, "cornell-water", "water", {"walls above the water", 0.05, 0.2, 0.95, 0.6},
                          {"below the water", 0.05, 0.78, 0.95, 0.96}));
  cases.push_back(measure(context, "cornell-glass", "glass", {"floor before the spheres", 0.1, 0.85, 0.9, 0.97},
                          {"floor through the clear sphere", 0.32, 0.56, 0.445, 0.64}));
  ExperimentResult result;
  for (const Case& c : cases) {
    for (const auto claim : {claim_gain, claim_first, claim_layer, claim_merging, claim_behind})
      result.claims.push_back(claim(c));
  }
  result.blocks.emplace_back(table(cases));
  for (const Case& c : cases) show(c, result.blocks);
  result.setup = {
      {"Size", square_text(context, kSide)},
      {"Bounces", fmt::format("{}, with roulette", kBounces)},
      {"Equal time", fmt::format("{} s per contender, alternately, six repetitions", kEqualTime_s)},
      {"Reference", fmt::format("{} samples of vcm, radius 0.002, alpha 0.75", cases.front().time.reference.spp)}};
  return result;
}

}  // namespace

Experiment caustics_experiment() {
  return {"caustics", kPaper, "caustics by paths from both sides, merging and reuse, at equal time", run_caustics};
}

}  // namespace relume
