// Finds the best combination of techniques for images that change: combinations and presets at equal time, while the
// camera rests, turns or walks, and while the scene changes.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/moving_error.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "render/presets.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr const char* kInteractive = "interactive";
constexpr const char* kPapers[] = {"paper-000", "paper-001", "paper-002", "paper-003", "paper-004"};

constexpr int kRepetitions = 2;
constexpr int kManyRepetitions = 8;  // for claims with intervals

constexpr int kBounces = 6;
constexpr int kCorridorBounces = 32;
constexpr int kCorridorSpp = 256;       // of the reference by bdpt
constexpr float kFrameRate = 24;        // of animations, in frames of `interactive` per second
constexpr float kBeforeDoor_s = 0.55f;  // in `base-1`: a door in view opens from 0.65 s to 1.65 s; lamps flicker

struct Variation {
  std::string name;
  std::string json;
};

MovingContender contender(const ExperimentScene& scene, std::string name, std::string_view json) {
  MovingContender result{std::move(name), scene.settings};
  settings_from_json(describe(result.settings), json, result.name);
  return result;
}

/// Final stages.
const Variation kEnds[] = {{", bmfr", R"({"denoise": "bmfr"})"}, {", svgf", R"({"denoise": "svgf"})"}};

const Variation kTransports[] = {
    {"power", R"({"lights": "power"})"},
    {"light-tree", R"({"lights": "light-tree"})"},
    {"static-lists", R"({"lights": "static-lists"})"},
    {"vlc", R"({"lights": "vlc"})"},
    {"neeat", R"({"lights": "neeat"})"},
    {"cdq", R"({"guide": "cdq", "lights": "light-tree"})"},
    {"vlc, cdq", R"({"lights": "vlc", "guide": "cdq"})"},
    {"psf, light-tree", R"({"cache": "psf", "lights": "light-tree"})"},
    {"apsf, light-tree", R"({"cache": "apsf", "lights": "light-tree"})"},
    {"apg, light-tree", R"({"cache": "apg", "lights": "light-tree"})"},
    {"apsf+apg, light-tree", R"({"cache": "apsf+apg", "lights": "light-tree"})"},
    {"bdpt", R"({"estimator": "bdpt"})"},
};

/// Combinations outside the product of the lists above: techniques that came after the papers, and others. Adaptive
/// sampling needs a reprojected history for its noise estimate while the camera moves.
const Variation kSingles[] = {
    {"ris, vlc, svgf", R"({"reuse": "ris", "lights": "vlc", "denoise": "svgf"})"},
    {"restir-di, svgf", R"({"reuse": "restir-di", "denoise": "svgf"})"},
    {"restir-gi, vlc, svgf", R"({"reuse": "restir-gi", "lights": "vlc", "denoise": "svgf"})"},
    {"restir-di+gi, svgf", R"({"reuse": "restir-di+gi", "denoise": "svgf"})"},
    {"restir-di+gi, vlc, svgf", R"({"reuse": "restir-di+gi", "lights": "vlc", "denoise": "svgf"})"},
    {"restir-pt, svgf", R"({"reuse": "restir-pt", "denoise": "svgf"})"},
    {"mcpg, light-tree, svgf", R"({"guide": "mcpg", "lights": "light-tree", "denoise": "svgf"})"},
    {"mcls, svgf", R"({"lights": "mcls", "denoise": "svgf"})"},
    {"sharc, light-tree, svgf", R"({"cache": "sharc", "lights": "light-tree", "denoise": "svgf"})"},
    {"psf, vlc, svgf", R"({"cache": "psf", "lights": "vlc", "denoise": "svgf"})"},
    {"apg, vlc, svgf", R"({"cache": "apg", "lights": "vlc", "denoise": "svgf"})"},
    {"apsf, light-tree", R"({"cache": "apsf", "lights": "light-tree", "history": "none"})"},
    {"apsf+apg, light-tree", R"({"cache": "apsf+apg", "lights": "light-tree", "history": "none"})"},
    {"vlc, asvgf", R"({"lights": "vlc", "denoise": "asvgf"})"},
    {"vlc, cdq, asvgf", R"({"lights": "vlc", "guide": "cdq", "denoise": "asvgf"})"},
    {"light-tree, asvgf", R"({"lights": "light-tree", "denoise": "asvgf"})"},
    {"light-tree, adaptive, reprojected, svgf",
     R"({"lights": "light-tree", "allocation": "adaptive", "history": "reproject", "reproject.method": "backward",
         "denoise": "svgf"})"},
    {"apg, light-tree, adaptive, reprojected, svgf",
     R"({"cache": "apg", "lights": "light-tree", "allocation": "adaptive", "history": "reproject",
         "reproject.method": "backward", "denoise": "svgf"})"},
    {"apg, vlc, adaptive, reprojected, svgf",
     R"({"cache": "apg", "lights": "vlc", "allocation": "adaptive", "history": "reproject",
         "reproject.method": "backward", "denoise": "svgf"})"},
};

/// Candidates for the preset, repeated more often to rank them.
constexpr std::string_view kCandidates[] = {"vlc, svgf",
                                            "vlc, asvgf",
                                            "vlc, cdq, svgf",
                                            "light-tree, svgf",
                                            "light-tree, asvgf",
                                            "apg, light-tree, svgf",
                                            "apg, vlc, svgf",
                                            "apg, light-tree, adaptive, reprojected, svgf",
                                            "apg, vlc, adaptive, reprojected, svgf",
                                            "restir-di+gi, vlc, svgf"};

bool is_candidate(const MovingContender& contender) {
  return std::find(std::begin(kCandidates), std::end(kCandidates), contender.name) != std::end(kCandidates);
}

std::vector<MovingContender> combinations(const ExperimentScene& scene) {
  std::vector<MovingContender> list;
  for (const Variation& transport : kTransports) {
    for (const Variation& end : kEnds) {
      MovingContender next = contender(scene, transport.name + end.name, transport.json);
      settings_from_json(describe(next.settings), end.json, next.name);
      list.push_back(std::move(next));
    }
  }
  for (const Variation& single : kSingles) list.push_back(contender(scene, single.name, single.json));
  return list;
}

/// Presets, then combinations. `interactive` comes first: the time of its frames is the common budget.
std::vector<MovingContender> contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<MovingContender> list{contender(scene, kInteractive, require_preset(kInteractive).json)};
  for (const char* name : kPapers) list.push_back(contender(scene, name, require_preset(name).json));
  for (MovingContender& preset : list) preset.repetitions = context.choose(kManyRepetitions, 2);
  if (context.quick) return list;
  for (MovingContender& next : combinations(scene)) {
    if (is_candidate(next)) next.repetitions = kManyRepetitions;
    list.push_back(std::move(next));
  }
  return list;
}

/// `interactive`, then the candidates for the preset.
std::vector<MovingContender> candidates(const ExperimentScene& scene) {
  std::vector<MovingContender> list{contender(scene, kInteractive, require_preset(kInteractive).json)};
  for (MovingContender& next : combinations(scene)) {
    if (is_candidate(next)) list.push_back(std::move(next));
  }
  return list;
}

/// At least a twentieth of the reference's MSE: below, the difference of both is noise, and may not even be positive.
double error_of(const MovingErrors& scene, double mse) { return std::max({mse, 0.05 * scene.reference_mse, 1e-12}); }

/// Geometric mean over the scenes of each contender's MSE over the lowest MSE.
std::vector<double> distances_to_best(const std::vector<MovingErrors>& scenes) {
  std::vector<double> logs(scenes.front().contenders.size(), 0);
  for (const MovingErrors& scene : scenes) {
    double least = error_of(scene, scene.contenders.front().mse);
    for (const MovingError& e : scene.contenders) least = std::min(least, error_of(scene, e.mse));
    for (size_t i = 0; i < logs.size(); ++i)
      logs[i] += std::log(error_of(scene, scene.contenders[i].mse) / least) / static_cast<double>(scenes.size());
  }
  for (double& value : logs) value = std::exp(value);
  return logs;
}

TableBlock table(std::string title, const std::string& motion, const std::vector<MovingErrors>& scenes) {
  TableBlock block{std::move(title),
                   fmt::format("MSE of the displayed image {}, at equal time, with FLIP, the number of frames and "
                               "their share of the time. Only whole frames count, so a slow technique may use up to "
                               "50 % more or less time. The first column is the geometric mean of the MSE over the "
                               "lowest in each scene.",
                               motion),
                   "techniques",
                   {{"over the best", "", Better::lower}},
                   {}};
  for (const MovingErrors& scene : scenes) block.columns.push_back({scene.scene, "", Better::lower});
  const std::vector<double> distances = distances_to_best(scenes);
  for (size_t i = 0; i < distances.size(); ++i) {
    TableRow row{.name = scenes.front().contenders[i].name,
                 .cells = {{fmt::format("{:.2f}", distances[i]), distances[i]}}};
    for (const MovingErrors& scene : scenes) {
      const MovingError& e = scene.contenders[i];
      row.cells.push_back(
          {fmt::format("{:.3e}", e.mse), e.mse,
           fmt::format("FLIP {:.3f}, {} frames, {:.0f} % of the time", e.flip, e.frames, 100 * e.time_share)});
    }
    block.rows.push_back(std::move(row));
  }
  std::stable_sort(block.rows.begin(), block.rows.end(),
                   [](const TableRow& a, const TableRow& b) { return a.cells.front().value < b.cells.front().value; });
  return block;
}

Claim claim_scene(const MovingErrors& scene) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const char* paper : kPapers) {
    ratios.push_back(error_ratio(named(scene.contenders, "contender", paper).mses,
                                 named(scene.contenders, "contender", kInteractive).mses));
    measured += fmt::format("{}{} {} in {:.0f} % of the time", measured.empty() ? "" : ", ", paper,
                            to_text(ratios.back()), 100 * named(scene.contenders, "contender", paper).time_share);
  }
  std::string id = scene.scene;
  std::transform(id.begin(), id.end(), id.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return judged_ratios(
      "beats-papers-" + id, kOurs,
      scene.scene + ": the preset `interactive` has less error than any single paper's, at equal time.",
      measured + " of its MSE", ratios, 1);
}

/// MSE of the named contender over that of `interactive`: geometric mean over the scenes.
Ratio gain_over(const std::vector<MovingErrors>& scenes, std::string_view name) {
  double log_value = 0;
  double squared_spread = 0;
  for (const MovingErrors& scene : scenes) {
    const auto errors = [&](std::string_view contender) {
      std::vector<double> mses = named(scene.contenders, "contender", std::string(contender)).mses;
      for (double& mse : mses) mse = error_of(scene, mse);
      return mses;
    };
    const Ratio ratio = error_ratio(errors(name), errors(kInteractive));
    log_value += std::log(ratio.value) / static_cast<double>(scenes.size());
    squared_spread += sqr(std::log(ratio.interval.high / ratio.value) / static_cast<double>(scenes.size()));
  }
  const double value = std::exp(log_value);
  const double spread = std::exp(std::sqrt(squared_spread));
  return {value, {value / spread, value * spread, 0.95}};
}

/// Claims that no candidate has 10 % less error than `interactive`. `when` is a clause that names the motion.
Claim claim_choice(std::string id, const std::string& when, const std::vector<MovingErrors>& scenes) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const std::string_view name : kCandidates) {
    ratios.push_back(gain_over(scenes, name));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : "; ", name, to_text(ratios.back()));
  }
  const std::vector<double> distances = distances_to_best(scenes);
  const size_t best = static_cast<size_t>(std::min_element(distances.begin(), distances.end()) - distances.begin());
  measured += fmt::format(" of its MSE; the least of the table has {}, {:.2f} against {:.2f}",
                          scenes.front().contenders[best].name, distances[best], distances.front());
  return judged_ratios(std::move(id), kOurs,
                       fmt::format("No candidate has 10 % less error than `interactive` {}.", when), measured, ratios,
                       0.9);
}

/// Reference and the first `count` contenders.
ImageSet images(const MovingErrors& scene, size_t count) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < count; ++i) {
    const MovingError& e = scene.contenders[i];
    images.push_back({e.name, static_cast<int>(i), &e.last, fmt::format("mean MSE {:.2e}", e.mse)});
  }
  return measured_set(scene.scene, scene.reference, images, {.values = false});
}

/// A scene, and how it moves.
struct Place {
  ExperimentScene scene;
  MovingOptions options;
};

MovingOptions base_options(const ExperimentContext& context) {
  return {.frames = context.choose(12, 3),
          .repetitions = context.choose(kRepetitions, 1),
          .reference_spp = context.choose(1024, 16)};
}

/// The same for `warehouse`: with the light tree, the noise of references would exceed some of the errors.
MovingOptions of_warehouse(MovingOptions options) {
  options.reference = "lights:vlc";
  return options;
}

/// Scenes in which the camera turns. With few bounces, most of the light of `corridor` would be missing. The paths of
/// its reference also start at the lamp.
std::vector<Place> turning(const ExperimentContext& context) {
  std::vector<Place> list;
  const MovingOptions options = base_options(context);
  if (std::optional<ExperimentScene> hall = sponza(context)) list.push_back({std::move(*hall), options});
  list.push_back({at_rest(built_in("cornell", kBounces)), options});
  list.push_back({at_rest(built_in("corridor", kCorridorBounces)), options});
  list.back().options.reference_spp = context.choose(kCorridorSpp, 16);
  list.back().options.reference = "estimator:bdpt";
  list.push_back({learning_scene("warehouse"), of_warehouse(options)});
  list.push_back({learning_scene("mine"), options});
  return list;
}

/// Scenes that only the candidates render, by motion. In `changing`, lamps and doors move while the camera rests.
struct Motions {
  std::vector<Place> still;
  std::vector<Place> walking;
  std::vector<Place> changing;
};

Motions motions(const ExperimentContext& context) {
  Motions list;
  MovingOptions options = base_options(context);
  options.repetitions = context.choose(kManyRepetitions, 1);
  options.step_deg = 0;
  const auto frames = static_cast<float>(options.frames);
  const auto renamed = [](ExperimentScene scene, const char* motion) {
    scene.name = fmt::format("{}, {}", scene.name, motion);
    return scene;
  };
  if (!context.quick) {
    list.still.push_back({renamed(learning_scene("warehouse"), "still"), of_warehouse(options)});
    Place walk{renamed(learning_scene("warehouse"), "walking"), of_warehouse(options)};
    walk.options.step_m = kWalkStep_m * frames;
    walk.options.step_deg = kWalkTurn_deg * frames;
    walk.scene.camera =
        turned_ahead(walk.scene, 0, walk.options.step_m);  // so that the walk begins at the scene's view
    list.walking.push_back(std::move(walk));
  }
  options.animation_step_s = frames / kFrameRate;
  list.changing.push_back({renamed(at_rest(built_in("turntable", kBounces)), "changing"), options});
  if (context.quick) return list;
  list.changing.push_back({renamed(at_rest(built_in("slit", kBounces)), "changing"), options});
  list.changing.push_back({renamed(learning_scene("base-1"), "changing"), options});
  list.changing.back().scene.settings.time_s = kBeforeDoor_s;
  return list;
}

/// Claims about the candidates by motion, and their table.
void measure_motions(const ExperimentContext& context, ExperimentResult& result, std::vector<ImageSet>& sets) {
  const Motions places = motions(context);
  std::vector<MovingErrors> all;
  for (const auto& [id, when, list] :
       {std::tuple("best-choice-still", "while nothing moves", &places.still),
        std::tuple("best-choice-walking", "while the camera walks", &places.walking),
        std::tuple("best-choice-changing", "while the scene changes", &places.changing)}) {
    std::vector<MovingErrors> scenes;
    for (const Place& place : *list)
      scenes.push_back(measure_moving(context, place.scene, candidates(place.scene), place.options));
    if (!context.quick) result.claims.push_back(claim_choice(id, when, scenes));
    for (MovingErrors& scene : scenes) all.push_back(std::move(scene));
  }
  result.blocks.emplace_back(table("Candidates", "while nothing moves, the camera walks, or the scene changes", all));
  for (const MovingErrors& scene : all) sets.push_back(images(scene, scene.contenders.size()));
}

std::vector<std::pair<std::string, std::string>> setup(const ExperimentContext& context) {
  const MovingOptions options = base_options(context);
  return {{"Camera", fmt::format("turns by 10° from view to view; two views are measured, in each of {} repetitions "
                                 "({} of presets and of candidates for the preset)",
                                 options.repetitions, context.choose(kManyRepetitions, 2))},
          {"Candidates", fmt::format("also measured without motion, while the camera walks by 5 cm and turns by 0.5° "
                                     "per frame of `interactive`, and while the scene changes. Changes take {} frames "
                                     "of `interactive` per second of the animation. A lamp turns in `turntable`, "
                                     "lamps move behind a slit in `slit`, and a door opens under flickering lamps in "
                                     "`base-1`",
                                     static_cast<int>(kFrameRate))},
          {"Time", fmt::format("that of {} frames of `interactive` between views; a slow technique has fewer frames",
                               options.frames)},
          {"Bounces",
           fmt::format("{}; {} in `corridor`; 2 in `warehouse`, `mine` and `base-1`", kBounces, kCorridorBounces)},
          {"Size", size_text(context)},
          {"Reference", fmt::format("{} samples per pixel by path tracing with the light tree (`warehouse`: "
                                    "with vlc), {} by bdpt in `corridor`; its own noise is known and subtracted from "
                                    "MSE, not from FLIP",
                                    options.reference_spp, context.choose(kCorridorSpp, 16))}};
}

ExperimentResult run_interactive(const ExperimentContext& context) {
  std::vector<MovingErrors> scenes;
  for (const Place& place : turning(context))
    scenes.push_back(measure_moving(context, place.scene, contenders(context, place.scene), place.options));

  ExperimentResult result;
  for (const MovingErrors& scene : scenes) result.claims.push_back(claim_scene(scene));
  if (context.scene_folder.empty()) {
    result.claims.push_back(unmeasured("beats-papers-sponza", kOurs,
                                       "Sponza: the preset `interactive` has less error than any single paper's, at "
                                       "equal time.",
                                       "every ratio above 1", kNoSponza));
  }
  if (!context.quick)
    result.claims.push_back(claim_choice("best-choice", "over all scenes, while the camera turns", scenes));
  result.blocks.emplace_back(table("Combinations", "while the camera turns", scenes));
  std::vector<ImageSet> sets;
  for (const MovingErrors& scene : scenes) sets.push_back(images(scene, 1 + std::size(kPapers)));
  measure_motions(context, result, sets);
  result.blocks.emplace_back(ViewerBlock{"Images",
                                         "Displayed image at the last view; with the mean MSE over both views and all "
                                         "repetitions.",
                                         image_layer_kinds(), std::move(sets)});
  result.setup = setup(context);
  return result;
}

}  // namespace

Experiment interactive_experiment() {
  return {kInteractive, kOurs, "combinations and presets at equal time, while the camera or the scene moves",
          run_interactive};
}

}  // namespace relume
