// [Sun20 §5.1]: noise of bidirectional path tracing against that of path tracing, where there are caustics, mirrors and
// lamps that light the ceiling.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/all.h"
#include "experiments/measure/regions.h"
#include "experiments/setup/named.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sun20 §5.1]";
constexpr const char* kOurs = "[relume]";
constexpr int kBounces = 8;
constexpr int kSide = 160;

/// Without the lamp, whose edges are as noisy with every estimator, and brighter than all the rest.
const Rectangle kAboveWater = {"walls above the water", 0.05, 0.2, 0.95, 0.6};

struct Case {
  std::string name;  ///< of the scene
  Rectangle region;  ///< what the claim is about
  Comparison samples;
  Comparison time;
};

/// Everybody is measured against bidirectional path tracing.
StudyOptions options_of(const ExperimentContext& context, const std::string& techniques) {
  StudyOptions options{.techniques = techniques, .repetitions = 6, .reference_spp = 512};
  use_square(context, kSide, options);
  options.common.emplace_back("estimator", "bdpt");
  options.reference = {{"estimator", "bdpt"}};
  return options;
}

constexpr const char* kBoth = "path=estimator:path,bdpt=estimator:bdpt";

Case measure(const ExperimentContext& context, const ExperimentScene& scene, Rectangle region) {
  StudyOptions samples = options_of(context, kBoth);
  samples.spp = context.choose(16, 4);
  StudyOptions time = options_of(context, kBoth);
  time.budget_s = 2;
  return {scene.name, std::move(region), study(context, scene, samples), study(context, scene, time)};
}

double region_ratio(const Comparison& c, const Rectangle& region) {
  return region_mse(c, "path", region) / region_mse(c, "bdpt", region);
}

double ratio(const Comparison& c) { return region_ratio(c, {"picture"}); }

TableBlock table(const std::vector<Case>& cases) {
  TableBlock block{"Path tracing's MSE over that of bidirectional path tracing",
                   "Above 1: bidirectional path tracing has less noise. Means over the repetitions.",
                   "scene",
                   {{"equal samples"}, {"equal time"}, {"region"}, {"equal samples, region"}, {"equal time, region"}},
                   {}};
  const auto cell = [](double x) { return TableCell{short_number(x), x}; };
  for (const Case& c : cases) {
    block.rows.push_back({c.name,
                          kNeutralColor,
                          {cell(ratio(c.samples)),
                           cell(ratio(c.time)),
                           {c.region.name},
                           cell(region_ratio(c.samples, c.region)),
                           cell(region_ratio(c.time, c.region))}});
  }
  return block;
}

Claim claim_less_noise(const std::vector<Case>& cases) {
  std::string measured;
  bool holds = true;
  for (const char* scene : {"cornell-spheres", "cornell-mirror", "cornell-water"}) {
    const double value = ratio(named(cases, scene).samples);
    holds = holds && value > 1;
    measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", scene, short_number(value));
  }
  return judged("less-noise", "[Sun20 §5.1.1]", "At equal samples bidirectional path tracing has less noise.",
                "path tracing's MSE over its own: " + measured, "above 1 in every scene", holds);
}

/// Forty frames of path tracing and ten of bidirectional path tracing, as in the paper.
void claim_frames(const ExperimentContext& context, std::vector<Claim>& claims) {
  const auto compare = [&](const char* name) {
    const ExperimentScene scene = built_in(name, kBounces);
    StudyOptions forty = options_of(context, "path=estimator:path");
    forty.spp = 40;
    StudyOptions ten = options_of(context, "bdpt=estimator:bdpt");
    ten.spp = 10;
    return std::pair(study(context, scene, forty), study(context, scene, ten));
  };
  const auto [mirror_path, mirror_bdpt] = compare("cornell-mirror");
  const double mirror = region_mse(mirror_path, "path", {"picture"}) / region_mse(mirror_bdpt, "bdpt", {"picture"});
  claims.push_back(judged("ten-frames-mirror", "[Sun20 §5.1.2]",
                          "On the box with a mirror, 10 frames have as little noise as 40 of path tracing.",
                          fmt::format("path tracing's MSE over its own: {}", short_number(mirror)), "at least 0.8",
                          mirror >= 0.8));
  const auto [water_path, water_bdpt] = compare("cornell-water");
  const Rectangle& walls = kAboveWater;
  const double water = region_mse(water_path, "path", walls) / region_mse(water_bdpt, "bdpt", walls);
  claims.push_back(judged("ten-frames-water", "[Sun20 §5.1.2]",
                          "Above the water, caustics are clearer after 10 frames than after 40 of path tracing.",
                          fmt::format("path tracing's MSE over its own, there: {}", short_number(water)), "above 1",
                          water > 1));
}

Claim claim_region(const Case& c, std::string id, const char* paper, double factor) {
  const double value = region_ratio(c.time, c.region);
  return judged(
      std::move(id), paper,
      fmt::format("{}: at equal time its MSE is lower by a factor of {} at least ({}).", c.name, factor, c.region.name),
      fmt::format("{} ({} over the picture)", short_number(value), short_number(ratio(c.time))),
      fmt::format("at least {}", factor), value >= factor);
}

/// The reference by an estimator that shares nothing but the light subpaths: mean of a region in plain view.
Claim claim_reference(const ExperimentContext& context, const std::vector<Case>& cases) {
  std::string measured;
  double worst = 0;
  for (const char* scene : {"cornell-water", "cornell-glass"}) {
    StudyOptions options = options_of(context, "light=estimator:light");
    options.spp = context.choose(64, 16);
    const Comparison c = study(context, built_in(scene, kBounces), options);
    const Rectangle& region = named(cases, scene).region;
    const double difference =
        region_mean(contender_named(c, "light").image, region) / region_mean(c.reference.image, region) - 1;
    worst = std::max(worst, std::fabs(difference));
    measured += fmt::format("{}{}: {:+.2f} %", measured.empty() ? "" : ", ", scene, 100 * difference);
  }
  return judged("reference", kPaper, "Light tracing finds the caustics as bright as the reference has them.", measured,
                "within 1 %", worst <= 0.01);
}

ExperimentResult run_bdpt_quality(const ExperimentContext& context) {
  std::vector<Case> cases;
  const auto add = [&](const char* name, Rectangle region) {
    cases.push_back(measure(context, built_in(name, kBounces), std::move(region)));
  };
  add("cornell-spheres", {"caustic on the floor", 0.55, 0.82, 0.95, 0.97});
  add("cornell-mirror", {"mirror", 0.2, 0.2, 0.8, 0.7});
  add("cornell-water", kAboveWater);
  add("cornell-glass", {"floor before the spheres", 0.1, 0.85, 0.9, 0.97});
  add("lamp-room", {"picture"});
  add("door", {"picture"});
  if (const std::optional<ExperimentScene> hall = sponza(context))
    cases.push_back(measure(context, *hall, {"picture"}));
  ExperimentResult result;
  result.claims.push_back(claim_less_noise(cases));
  claim_frames(context, result.claims);
  result.claims.push_back(claim_region(named(cases, "cornell-water"), "time-water", kOurs, 5));
  result.claims.push_back(claim_region(named(cases, "cornell-glass"), "time-glass", kOurs, 5));
  result.claims.push_back(claim_region(named(cases, "lamp-room"), "time-lamps", kOurs, 2));
  result.claims.push_back(claim_reference(context, cases));
  result.blocks.emplace_back(table(cases));
  for (const Case& c : cases) result.blocks.emplace_back(region_pictures(c.name + ", equal time", c.time, {c.region}));
  for (const Case& c : cases) {
    for (Block& block : study_blocks(c.name + ", equal time", c.time)) {
      if (!std::holds_alternative<ViewerBlock>(block)) result.blocks.push_back(std::move(block));
    }
  }
  result.setup = {{"Size", square_text(context, kSide)},
                  {"Reference", context.quick ? "256 samples of bdpt" : "512 samples of bdpt"},
                  {"Bounces", fmt::format("{}, with roulette", kBounces)},
                  {"Equal samples", context.quick ? "4" : "16"},
                  {"Equal time", context.quick ? "0.2 s" : "2 s"}};
  return result;
}

}  // namespace

Experiment bdpt_quality_experiment() {
  return {"bdpt-quality", kPaper, "bidirectional against plain path tracing: caustics, mirrors, indirect lamps",
          run_bdpt_quality};
}

}  // namespace relume
