// [Dittebrandt20 §7.1]: compares adapted directions from a compressed quadtree with BSDF sampling at one sample per
// pixel, and measures each deviation from the paper.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/guiding_contenders.h"
#include "experiments/measure/learning_modes.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/guiding_scenes.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.1]";
constexpr const char* kOurs = "[relume]";

struct SceneResult {
  std::string name;
  std::vector<PixelMask> regions;
  std::vector<AdaptedError> errors;  ///< BSDF sampling first, then guiding in the order of `kGuided`
  ImageSet images;
};

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene, GuidingExtent extent) {
  const int spp = learning_reference_spp(context, scene.scale);
  const Reference reference = make_reference(context, plainly_sampled(scene), spp);
  SceneResult result{scene.name, {surfaces_of(context, scene)}, {}, {}};
  if (scene.name.starts_with("mine")) {
    ExperimentScene direct = plainly_sampled(scene);
    direct.settings.path.max_bounces = 1;
    result.regions = mine_regions(reference.image, make_reference(context, direct, context.choose(64, 16)).image,
                                  result.regions.front());
  }
  result.errors = measure_adapted(context, scene, guiding_contenders(context, scene, extent), reference, result.regions,
                                  adapted_options(context, scene.scale));
  result.images = adapted_images(scene.name, result.errors, reference.image);
  return result;
}

Ratio gain(const SceneResult& scene, const GuidedContender& guided, size_t region) {
  return error_ratio(scene.errors[0].mse[region], scene.errors[guided.contender].mse[region]);
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{scene.name,
                   "Factor by which the mean squared error of single frames is lower than with BSDF sampling, by "
                   "region of the image, at equal samples, with 95 % intervals.",
                   "directions",
                   {{"ms per frame", "", Better::lower}},
                   {}};
  for (const PixelMask& region : scene.regions)
    block.columns.push_back(
        {fmt::format("{} ({:.0f} %)", region.name,
                     100.0 * static_cast<double>(region.pixels()) / static_cast<double>(region.mask.size())),
         "", Better::higher});
  block.columns.push_back({"surfaces, times time", "", Better::higher});
  int color = 0;
  for (const AdaptedError& e : scene.errors) {
    TableRow row{e.name, color++, {{fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()}}};
    for (size_t region = 0; region < scene.regions.size(); ++region) {
      const Ratio ratio = error_ratio(scene.errors[0].mse[region], e.mse[region]);
      row.cells.push_back({to_text(ratio), ratio.value, fmt::format("MSE {:.2e}", e.mean_mse(region))});
    }
    const Ratio equal_time = equal_time_ratio(scene.errors[0], e);
    row.cells.push_back({to_text(equal_time), equal_time.value});
    block.rows.push_back(std::move(row));
  }
  return block;
}

void claim_mine(const SceneResult& paper, const SceneResult& sampled, const GuidedContender& guided,
                std::vector<Claim>& claims) {
  const Ratio sun = gain(paper, guided, 1);
  const Ratio spot = gain(paper, guided, 2);
  const std::string measured =
      fmt::format("sun {}, spot {}; sampling the sun itself {} and {}", to_text(sun), to_text(spot),
                  to_text(error_ratio(paper.errors[0].mse[1], paper.errors[kEnvironmentSampled].mse[1])),
                  to_text(error_ratio(paper.errors[0].mse[2], paper.errors[kEnvironmentSampled].mse[2])));
  claims.push_back(
      judged_ratios(fmt::format("mine-orders{}", guided.suffix), guided.source,
                    fmt::format("Where the sun and its spot light the mine, guiding ({}) has two to three orders of "
                                "magnitude less error; next event estimation excludes the environment.",
                                guided.name),
                    measured, {sun, spot}, 100));
  claims.push_back(judged_ratios(
      fmt::format("mine-sun{}", guided.suffix), kOurs,
      fmt::format(
          "Where the sun and its spot light the mine, guiding ({}) has at least 30 times less error; next event "
          "estimation excludes the environment.",
          guided.name),
      measured, {sun, spot}, 30));
  const Ratio indirect = gain(sampled, guided, 2);
  claims.push_back(judged_ratios(fmt::format("mine-sampled{}", guided.suffix), kOurs,
                                 fmt::format("With the environment sampled, guiding ({}) still helps where the spot "
                                             "lights indirectly.",
                                             guided.name),
                                 to_text(indirect), {indirect}, 3));
  const Ratio time_paper = equal_time_ratio(paper.errors[0], paper.errors[guided.contender]);
  const Ratio time_sampled = equal_time_ratio(sampled.errors[0], sampled.errors[guided.contender]);
  claims.push_back(
      judged_ratios(fmt::format("mine-equal-time{}", guided.suffix), kOurs,
                    fmt::format("On `mine` guiding ({}) has the lower product of MSE and frame time.", guided.name),
                    fmt::format("{} in the paper's setting, {} with the environment sampled", to_text(time_paper),
                                to_text(time_sampled)),
                    {time_paper, time_sampled}, 1));
}

/// The warehouse has the paper's uniform light. For the cover (§7.1) and the turntable (§7.3), the paper claims an
/// improvement.
void claim_elsewhere(const std::vector<SceneResult>& scenes, const GuidedContender& guided,
                     std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : scenes) {
    ratios.push_back(gain(scene, guided, 0));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(fmt::format("never-worse{}", guided.suffix), kOurs,
                                 fmt::format("Guiding ({}) does little harm anywhere else.", guided.name), measured,
                                 ratios, 1 / 1.3));
  const Ratio uniform = gain(named(scenes, "scene", "warehouse"), guided, 0);
  claims.push_back(
      judged_within(fmt::format("uniform-light{}", guided.suffix), guided.source,
                    fmt::format("`warehouse`: under uniform light guiding ({}) gives no gain.", guided.name),
                    to_text(uniform), "within 1/1.3 and 1.3", {uniform}, 1 / 1.3, 1.3));
  for (const SceneResult& scene : scenes) {
    if (scene.name != "cover" && scene.name != "turntable") continue;
    const Ratio ratio = gain(scene, guided, 0);
    claims.push_back(judged_ratios(fmt::format("gain-{}{}", scene.name, guided.suffix), guided.source,
                                   fmt::format("`{}`: guiding ({}) helps.", scene.name, guided.name), to_text(ratio),
                                   {ratio}, 1));
  }
}

void claim_suns(const SceneResult& ten, const std::vector<SceneResult>& smaller, std::vector<Claim>& claims) {
  std::string measured = fmt::format("10° {}", to_text(gain(ten, kGuided[1], 1)));
  std::vector<Ratio> ratios;
  for (const SceneResult& scene : smaller) {
    ratios.push_back(gain(scene, kGuided[1], 1));
    measured += fmt::format("; {} {}", scene.name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios("mine-small-suns", kOurs,
                                 "Smaller suns than the mine's: where they shine, guiding (lasting quadtrees) has at "
                                 "least 30 times less error.",
                                 measured, ratios, 30));
}

/// The region where guiding pays: of the sun in mines, otherwise all surfaces.
size_t region_of(const SceneResult& scene) { return scene.regions.size() > 1 ? 1 : 0; }

/// Claims that quadtrees, which ignore the parallax within a leaf, have no more error than Markov chains.
void claim_parallax(const std::vector<SceneResult>& scenes, const GuidedContender& guided, std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : scenes) {
    const AdaptedError& chains = named(scene.errors, "contender", kChains);
    ratios.push_back(error_ratio(chains.mse[region_of(scene)], scene.errors[guided.contender].mse[region_of(scene)]));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratios.back()));
  }
  claims.push_back(judged_ratios(fmt::format("parallax{}", guided.suffix), kOurs,
                                 fmt::format("Where light comes from few directions, guiding ({}) has no more error "
                                             "than Markov chains (mcpg), which account for parallax.",
                                             guided.name),
                                 measured, ratios, 1));
}

/// Claims about guiding with all modes where light comes from few directions.
void claim_few_directions(const std::vector<SceneResult>& scenes, std::vector<Claim>& claims) {
  for (const SceneResult& scene : scenes) {
    const bool mine = scene.regions.size() > 1;
    const double least = mine ? 25 : scene.name == "skylight" ? 2.3 : 1;
    std::string id = scene.name;
    if (const size_t comma = id.find(", "); comma != std::string::npos) id.replace(comma, 2, "-");
    for (const GuidedContender& guided : kGuided) {
      const auto add = [&](const std::string& contender, const std::string& suffix) {
        const Ratio ratio = error_ratio(scene.errors[0].mse[region_of(scene)],
                                        named(scene.errors, "contender", contender).mse[region_of(scene)]);
        claims.push_back(
            judged_ratios(id + suffix, kOurs,
                          fmt::format("`{}`{}: guiding ({}) has at least {} times less error.", scene.name,
                                      mine ? ", where the sun shines and is not sampled" : "", contender, least),
                          to_text(ratio), {ratio}, least));
      };
      const LearningMode& all = guiding_modes().back();
      add(guided.name, guided.suffix);
      add(with_mode(guided.name, all), fmt::format("{}-{}", guided.suffix, all.id));
    }
  }
}

/// Factors by which a mode of the paper's quadtrees lowers the error.
std::vector<ModeGain> gains_of(const std::vector<SceneResult>& scenes, const LearningMode& mode) {
  std::vector<ModeGain> gains;
  for (const SceneResult& scene : scenes) {
    const AdaptedError& with = named(scene.errors, "contender", with_mode(kGuided[0].name, mode));
    gains.push_back({scene.name, error_ratio(scene.errors[kGuided[0].contender].mse[region_of(scene)],
                                             with.mse[region_of(scene)])});
  }
  return gains;
}

/// Claims that decide the modes' defaults by their gains in small images, and that guiding with all of them does no
/// harm where light is uniform.
void claim_modes(const ExperimentContext& context, const std::vector<SceneResult>& small,
                 const std::vector<SceneResult>& others, std::vector<Claim>& claims) {
  for (const LearningMode& mode : modes_to_measure(context, guiding_modes()))
    claim_gain("mode", mode, kGuided[0].name, "where light comes from few directions", gains_of(small, mode), claims);
  claim_harmless("mode", guiding_modes().back(), kGuided[0].name, gains_of(others, guiding_modes().back()), claims);
  for (const GuidedContender& guided : kGuided) {
    const std::string name = with_mode(guided.name, guiding_modes().back());
    std::vector<Ratio> ratios;
    std::string measured;
    for (const SceneResult& scene : others) {
      ratios.push_back(error_ratio(scene.errors[0].mse[0], named(scene.errors, "contender", name).mse[0]));
      measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", scene.name, to_text(ratios.back()));
    }
    claims.push_back(judged_ratios(fmt::format("never-worse{}-all", guided.suffix), kOurs,
                                   fmt::format("Guiding ({}) has at most 1.02 times the error anywhere else.", name),
                                   measured, ratios, 1 / 1.02));
  }
}

/// Scenes with light from few directions.
struct FewDirections {
  std::vector<SceneResult> small;  ///< with each mode
  std::vector<SceneResult> large;  ///< with all modes; none in a quick run

  std::vector<SceneResult> all() const {
    std::vector<SceneResult> scenes = small;
    scenes.insert(scenes.end(), large.begin(), large.end());
    return scenes;
  }
};

FewDirections measure_few_directions(const ExperimentContext& context) {
  FewDirections few;
  for (const ExperimentScene& scene : {built_in_mine("mine-sun-5", ", small", 1), skylight(", small", 1)})
    few.small.push_back(measure(context, scene, GuidingExtent::each_mode));
  if (context.quick) return few;
  for (const ExperimentScene& scene : {skylight("", kMineScale), built_in_mine("mine-sun-5", "", kLargeScale),
                                       built_in_mine("mine-sun-1", "", kLargeScale)})
    few.large.push_back(measure(context, scene, GuidingExtent::all_modes));
  return few;
}

std::vector<SceneResult> measure_others(const ExperimentContext& context) {
  std::vector<SceneResult> results;
  std::vector<const char*> names{"warehouse"};
  if (!context.quick) names = {"warehouse", "cover", "turntable", "slit"};
  for (const char* name : names) {
    ExperimentScene scene = learning_scene(name);
    scene.settings.lights = LightSelectionChoice::vlc;
    results.push_back(measure(context, scene, GuidingExtent::all_modes));
  }
  if (const std::optional<ExperimentScene> hall = sponza_with_lamps(context))
    results.push_back(measure(context, *hall, GuidingExtent::all_modes));
  return results;
}

ExperimentResult run_guiding(const ExperimentContext& context) {
  const SceneResult paper_result =
      measure(context, mine("mine, environment not sampled", false, kMineScale), GuidingExtent::guided);
  const SceneResult sampled_result =
      measure(context, mine("mine, environment sampled", true, kMineScale), GuidingExtent::guided);
  // A quick run has no departures, and only small images.
  const SceneResult departures =
      context.quick
          ? paper_result
          : measure(context, mine("mine, environment not sampled, small", false, 1), GuidingExtent::departures);
  const FewDirections few = measure_few_directions(context);
  std::vector<SceneResult> suns{few.small.front()};
  if (!context.quick) suns.push_back(measure(context, mine_with_sun(2.5f), GuidingExtent::guided));
  const std::vector<SceneResult> others = measure_others(context);

  ExperimentResult result;
  for (const GuidedContender& guided : kGuided) {
    claim_mine(paper_result, sampled_result, guided, result.claims);
    claim_elsewhere(others, guided, result.claims);
    claim_parallax(few.small, guided, result.claims);
  }
  claim_suns(departures, suns, result.claims);
  claim_few_directions(few.all(), result.claims);
  claim_modes(context, few.small, others, result.claims);
  std::vector<SceneResult> all{paper_result, sampled_result, departures};
  all.insert(all.end(), suns.begin() + 1, suns.end());
  all.insert(all.end(), few.small.begin(), few.small.end());
  all.insert(all.end(), few.large.begin(), few.large.end());
  all.insert(all.end(), others.begin(), others.end());
  std::vector<ImageSet> images;
  for (const SceneResult& scene : all) images.push_back(scene.images);
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : all) result.blocks.emplace_back(table(scene));
  result.setup = adapted_setup(context);
  if (!context.quick) {
    result.setup.emplace_back(
        "Larger images",
        fmt::format("mine and skylight {0}×{0} times as many pixels, except for departures and images called small: "
                    "references of 192 samples, two sessions of 48 frames to adapt and 16 measured. mine-sun-5 and "
                    "mine-sun-1 {1}×{1} times as many: 64 samples, two sessions of 24 frames and 4",
                    kMineScale, kLargeScale));
  }
  result.setup.emplace_back("Regions",
                            "sun: direct light above a tenth of its 99.5th percentile; spot: more than half of the "
                            "light is indirect; both from references");
  return result;
}

}  // namespace

Experiment guiding_experiment() { return {"guiding", kPaper, "guided directions against BSDF sampling", run_guiding}; }

}  // namespace relume
