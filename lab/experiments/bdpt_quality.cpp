// [Sun20 §5.1]: compares the noise of bidirectional and unidirectional path tracing in scenes with caustics, mirrors
// and lamps that light the ceiling.
#include <iterator>
#include <utility>

#include <fmt/format.h>

#include "compare/comparison_page.h"
#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "experiments/setup/named.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sun20 §5.1]";
constexpr const char* kOurs = "[relume]";
constexpr int kBounces = 8;
constexpr int kPaperBounces = 4;  ///< D of [Sun20 §5.2.1], for point and directional lights
constexpr int kSide = 160;

/// Excludes the lamp: its edges are equally noisy with every estimator and brighter than the remainder.
const Rectangle kAboveWater = {"walls above the water", 0.05, 0.2, 0.95, 0.6};

struct Case {
  std::string name;  ///< scene
  Rectangle region;  ///< region of the claim
  Comparison samples;
  Comparison time;
};

/// Options with bidirectional path tracing for the reference.
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

/// MSE of path tracing over that of bidirectional path tracing.
Ratio gain(const Comparison& c, const Rectangle& region = {"image"}) { return region_ratio(c, "path", "bdpt", region); }

TableBlock table(const std::vector<Case>& cases) {
  TableBlock block{"Path tracing's MSE over that of bidirectional path tracing",
                   "Above 1: bidirectional path tracing has less noise. Means over the repetitions.",
                   "scene",
                   {{"equal samples"}, {"equal time"}, {"region"}, {"equal samples, region"}, {"equal time, region"}},
                   {}};
  const auto cell = [](const Ratio& r) { return TableCell{short_number(r.value), r.value, to_text(r)}; };
  for (const Case& c : cases) {
    block.rows.push_back({c.name,
                          kNeutralColor,
                          {cell(gain(c.samples)),
                           cell(gain(c.time)),
                           {c.region.name},
                           cell(gain(c.samples, c.region)),
                           cell(gain(c.time, c.region))}});
  }
  return block;
}

/// Ratio of variances. Excludes energy that is also missing from the mean of path tracing's images.
Ratio noise_gain(const Comparison& path, const Comparison& bdpt, const Rectangle& region) {
  return error_ratio(region_variances(path, "path", region), region_variances(bdpt, "bdpt", region));
}
Ratio noise_gain(const Comparison& c, const Rectangle& region) { return noise_gain(c, c, region); }

/// Share of the region's energy that path tracing misses.
double light_missed(const Case& c) {
  std::vector<double> means;
  for (const Image& image : contender_named(c.samples, "path").images) means.push_back(region_mean(image, c.region));
  return 1 - mean(means) / region_mean(c.samples.reference.image, c.region);
}

TableBlock table_of_own_lights(const std::vector<Case>& cases) {
  TableBlock block{"The paper's own lights: path tracing over bidirectional path tracing",
                   fmt::format("{} bounces, one point or directional light. Noise is the variance between repetitions; "
                               "the MSE also contains light that path tracing cannot find.",
                               kPaperBounces),
                   "scene",
                   {{"region"},
                    {"noise, equal samples"},
                    {"noise, equal time"},
                    {"MSE, equal samples"},
                    {"MSE, equal time"},
                    {"light missing in path tracing"}},
                   {}};
  const auto cell = [](const Ratio& r) { return TableCell{to_text(r), r.value}; };
  for (const Case& c : cases) {
    const double missed = light_missed(c);
    block.rows.push_back({c.name,
                          kNeutralColor,
                          {{c.region.name},
                           cell(noise_gain(c.samples, c.region)),
                           cell(noise_gain(c.time, c.region)),
                           cell(gain(c.samples, c.region)),
                           cell(gain(c.time, c.region)),
                           {fmt::format("{:.1f} %", 100 * missed), missed}}});
  }
  return block;
}

Claim claim_less_noise(const std::vector<Case>& cases) {
  std::string measured;
  std::vector<Ratio> gains;
  for (const char* scene : {"cornell-spheres", "cornell-mirror", "cornell-water"}) {
    gains.push_back(gain(named(cases, "scene", scene).samples));
    measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", scene, to_text(gains.back()));
  }
  return judged_ratios("less-noise", "[Sun20 §5.1.1]", "At equal samples bidirectional path tracing has less noise.",
                       "path tracing's MSE over its own: " + measured, gains, 1);
}

/// Forty frames of path tracing and ten of bidirectional path tracing, as in the paper.
std::pair<Comparison, Comparison> forty_and_ten(const ExperimentContext& context, const ExperimentScene& scene) {
  StudyOptions forty = options_of(context, "path=estimator:path");
  forty.spp = 40;
  StudyOptions ten = options_of(context, "bdpt=estimator:bdpt");
  ten.spp = 10;
  return {study(context, scene, forty), study(context, scene, ten)};
}

void claim_frames(const ExperimentContext& context, std::vector<Claim>& claims) {
  const auto [mirror_path, mirror_bdpt] = forty_and_ten(context, built_in("cornell-mirror", kBounces));
  const Rectangle all{"image"};
  const Ratio mirror = error_ratio(region_errors(mirror_path, "path", all), region_errors(mirror_bdpt, "bdpt", all));
  claims.push_back(judged_ratios("ten-frames-mirror", "[Sun20 §5.1.2]",
                                 "On the box with a mirror, 10 frames have as little noise as 40 of path tracing.",
                                 "path tracing's MSE over its own: " + to_text(mirror), {mirror}, 0.8));
  const auto [water_path, water_bdpt] = forty_and_ten(context, built_in("cornell-water", kBounces));
  const Rectangle& walls = kAboveWater;
  const Ratio water = error_ratio(region_errors(water_path, "path", walls), region_errors(water_bdpt, "bdpt", walls));
  claims.push_back(judged_ratios("ten-frames-water", "[Sun20 §5.1.2]",
                                 "Above the water, caustics are clearer after 10 frames than after 40 of path tracing.",
                                 "path tracing's MSE over its own, there: " + to_text(water), {water}, 1));
}

/// A light from the paper.
struct OwnLight {
  DeltaLight light;
  const char* id;
  const char* name;
};
constexpr OwnLight kOwnLights[] = {{DeltaLight::point, "point", "Under a point light"},
                                   {DeltaLight::directional, "directional", "Under light from a direction"}};

std::vector<Case> measure_under(const ExperimentContext& context, DeltaLight light) {
  return {measure(context, box_under("cornell-spheres", light, kPaperBounces), {"image"}),
          measure(context, box_under("cornell-mirror", light, kPaperBounces), {"image"}),
          measure(context, box_under("cornell-water", light, kPaperBounces), kAboveWater)};
}

/// Repeats the paper's claims about noise with its lights and its D.
void claim_own_light(const ExperimentContext& context, const OwnLight& own, const std::vector<Case>& cases,
                     std::vector<Claim>& claims) {
  const auto judge = [&](const char* id, const char* paper, const char* claim, const std::string& measured,
                         const std::vector<Ratio>& ratios, double least) {
    claims.push_back(judged_ratios(fmt::format("{}-{}", own.id, id), paper,
                                   fmt::format("{}, D = 4: {}", own.name, claim), "path tracing's " + measured, ratios,
                                   least));
  };
  std::string measured;
  std::vector<Ratio> gains;
  for (const Case& c : cases) {
    gains.push_back(noise_gain(c.samples, c.region));
    measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", c.name, to_text(gains.back()));
  }
  judge("less-noise", "[Sun20 §5.1.1]", "at equal samples it has less noise.", "variance over its own: " + measured,
        gains, 1);
  const auto [mirror_path, mirror_bdpt] = forty_and_ten(context, box_under("cornell-mirror", own.light, kPaperBounces));
  const Ratio mirror = noise_gain(mirror_path, mirror_bdpt, {"image"});
  judge("ten-frames-mirror", "[Sun20 §5.1.2]",
        "on the box with a mirror, 10 frames have as little noise as 40 of path tracing.",
        "variance over its own: " + to_text(mirror), {mirror}, 0.8);
  const auto [water_path, water_bdpt] = forty_and_ten(context, box_under("cornell-water", own.light, kPaperBounces));
  const Ratio water =
      error_ratio(region_errors(water_path, "path", kAboveWater), region_errors(water_bdpt, "bdpt", kAboveWater));
  judge("ten-frames-water", "[Sun20 §5.1.2]",
        "above the water, caustics are clearer after 10 frames than after 40 of path tracing.",
        "MSE over its own, there: " + to_text(water), {water}, 1);
}

Claim claim_region(const Case& c, std::string id, const char* paper, double factor) {
  const Ratio ratio = gain(c.time, c.region);
  return judged_ratios(
      std::move(id), paper,
      fmt::format("{}: at equal time bidirectional path tracing has an MSE lower by a factor of at least {} ({}).",
                  c.name, factor, c.region.name),
      fmt::format("{}; over the image {}", to_text(ratio), to_text(gain(c.time))), {ratio}, factor);
}

/// Checks the reference against an estimator that shares only the light subpaths: mean of a directly visible region.
Claim claim_reference(const ExperimentContext& context, const std::vector<Case>& cases) {
  std::string measured;
  std::vector<const char*> verdicts;
  for (const char* scene : {"cornell-water", "cornell-glass"}) {
    StudyOptions options = options_of(context, "light=estimator:light");
    options.spp = context.choose(64, 16);
    const Comparison c = study(context, built_in(scene, kBounces), options);
    const Rectangle& region = named(cases, "scene", scene).region;
    std::vector<double> differences;
    for (const Image& image : contender_named(c, "light").images)
      differences.push_back(region_mean(image, region) / region_mean(c.reference.image, region) - 1);
    const Interval interval = mean_interval(differences);
    verdicts.push_back(verdict_of(interval, -0.01, 0.01));
    measured += fmt::format("{}{}: {:+.2f} % ({:+.2f} to {:+.2f})", measured.empty() ? "" : ", ", scene,
                            100 * mean(differences), 100 * interval.low, 100 * interval.high);
  }
  return with_verdict("reference", kPaper, "Light tracing renders caustics as bright as the reference.", measured,
                      "within 1 %, by the interval", verdict_of_all(verdicts));
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
  add("lamp-room", {"image"});
  add("door", {"image"});
  if (const std::optional<ExperimentScene> hall = sponza(context)) cases.push_back(measure(context, *hall, {"image"}));
  ExperimentResult result;
  result.claims.push_back(claim_less_noise(cases));
  claim_frames(context, result.claims);
  result.claims.push_back(claim_region(named(cases, "scene", "cornell-water"), "time-water", kOurs, 5));
  result.claims.push_back(claim_region(named(cases, "scene", "cornell-glass"), "time-glass", kOurs, 5));
  result.claims.push_back(claim_region(named(cases, "scene", "lamp-room"), "time-lamps", kOurs, 2));
  result.claims.push_back(claim_reference(context, cases));
  std::vector<Case> own_lights;
  for (const OwnLight& own : kOwnLights) {
    std::vector<Case> under = measure_under(context, own.light);
    claim_own_light(context, own, under, result.claims);
    std::move(under.begin(), under.end(), std::back_inserter(own_lights));
  }
  result.blocks.emplace_back(table(cases));
  result.blocks.emplace_back(table_of_own_lights(own_lights));
  for (const Case& c : cases) result.blocks.emplace_back(region_images(c.name + ", equal time", c.time, {c.region}));
  for (const Case& c : own_lights)
    result.blocks.emplace_back(region_images(c.name + ", equal time", c.time, {c.region}));
  for (const Case& c : cases) {
    for (Block& block : study_blocks(c.name + ", equal time", c.time)) {
      if (!std::holds_alternative<ViewerBlock>(block)) result.blocks.push_back(std::move(block));
    }
  }
  result.setup = {
      {"Size", square_text(context, kSide)},
      {"Reference", fmt::format("{} samples of bdpt", cases.front().samples.reference.spp)},
      {"Bounces", fmt::format("{}, with roulette; {} under the paper's own lights", kBounces, kPaperBounces)},
      {"Equal samples", context.quick ? "4" : "16"},
      {"Equal time", context.quick ? "0.05 s" : "2 s"}};
  return result;
}

}  // namespace

Experiment bdpt_quality_experiment() {
  return {"bdpt-quality", kPaper, "bidirectional against plain path tracing: caustics, mirrors, indirect lamps",
          run_bdpt_quality};
}

}  // namespace relume
