// Finds the best combination of techniques for a moving camera: combinations and presets at equal time.
#include <algorithm>
#include <cmath>
#include <span>

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

struct Variation {
  std::string name;
  std::string json;
};

MovingContender contender(const ExperimentScene& scene, std::string name, std::string_view json) {
  MovingContender result{std::move(name), scene.settings};
  settings_from_json(describe(result.settings), json, result.name);
  return result;
}

/// Final stages: the last view alone, with reprojected history, and denoised.
const Variation kEnds[] = {{"", R"({"history": "none"})"},
                           {", reprojected", R"({"history": "reproject", "reproject.method": "backward"})"},
                           {", bmfr", R"({"denoise": "bmfr"})"},
                           {", svgf", R"({"denoise": "svgf"})"}};

const Variation kTransports[] = {
    {"power", R"({"lights": "power"})"},
    {"light-tree", R"({"lights": "light-tree"})"},
    {"static-lists", R"({"lights": "static-lists"})"},
    {"vlc", R"({"lights": "vlc"})"},
    {"neeat", R"({"lights": "neeat"})"},
    {"cdq", R"({"guide": "cdq", "lights": "light-tree"})"},
    {"vlc, cdq", R"({"lights": "vlc", "guide": "cdq"})"},
    {"psf", R"({"cache": "psf"})"},
    {"apsf", R"({"cache": "apsf"})"},
    {"apg", R"({"cache": "apg"})"},
    {"apsf+apg", R"({"cache": "apsf+apg"})"},
    {"psf, light-tree", R"({"cache": "psf", "lights": "light-tree"})"},
    {"apsf, light-tree", R"({"cache": "apsf", "lights": "light-tree"})"},
    {"apg, light-tree", R"({"cache": "apg", "lights": "light-tree"})"},
    {"apsf+apg, light-tree", R"({"cache": "apsf+apg", "lights": "light-tree"})"},
    {"bdpt", R"({"estimator": "bdpt"})"},
};

/// Techniques that came after the papers, and what combines with them.
const Variation kTodays[] = {
    {"ris, vlc", R"({"reuse": "ris", "lights": "vlc"})"},
    {"restir-di", R"({"reuse": "restir-di"})"},
    {"restir-gi, vlc", R"({"reuse": "restir-gi", "lights": "vlc"})"},
    {"restir-pt", R"({"reuse": "restir-pt"})"},
    {"mcpg, light-tree", R"({"guide": "mcpg", "lights": "light-tree"})"},
    {"mcls", R"({"lights": "mcls"})"},
    {"sharc, light-tree", R"({"cache": "sharc", "lights": "light-tree"})"},
    {"psf, vlc", R"({"cache": "psf", "lights": "vlc"})"},
    {"apg, vlc", R"({"cache": "apg", "lights": "vlc"})"},
};

const Variation kTodaysEnds[] = {{", reprojected", R"({"history": "reproject", "reproject.method": "backward"})"},
                                 {", svgf", R"({"denoise": "svgf"})"},
                                 {", asvgf", R"({"denoise": "asvgf"})"}};

/// Combinations outside the products of the lists above. Adaptive sampling needs a reprojected history for its noise
/// estimate while the camera moves.
const Variation kSingles[] = {
    {"vlc, asvgf", R"({"lights": "vlc", "denoise": "asvgf"})"},
    {"vlc, cdq, asvgf", R"({"lights": "vlc", "guide": "cdq", "denoise": "asvgf"})"},
    {"light-tree, asvgf", R"({"lights": "light-tree", "denoise": "asvgf"})"},
    {"light-tree, adaptive, reprojected",
     R"({"lights": "light-tree", "allocation": "adaptive", "history": "reproject", "reproject.method": "backward"})"},
    {"light-tree, adaptive, reprojected, svgf",
     R"({"lights": "light-tree", "allocation": "adaptive", "history": "reproject", "reproject.method": "backward",
         "denoise": "svgf"})"},
    {"apg, light-tree, adaptive, reprojected, svgf",
     R"({"cache": "apg", "lights": "light-tree", "allocation": "adaptive", "history": "reproject",
         "reproject.method": "backward", "denoise": "svgf"})"},
};

/// Candidates for the preset, repeated more often to rank them.
constexpr std::string_view kCandidates[] = {"vlc, svgf",        "vlc, cdq, svgf",        "static-lists, svgf",
                                            "light-tree, svgf", "psf, light-tree, svgf", "apg, light-tree, svgf",
                                            "psf, vlc, svgf",   "apg, vlc, svgf",        "restir-di, svgf"};

bool is_candidate(std::string_view name) {
  return std::find(std::begin(kCandidates), std::end(kCandidates), name) != std::end(kCandidates);
}

/// Appends every transport with every final stage.
void append_products(const ExperimentScene& scene, std::span<const Variation> transports,
                     std::span<const Variation> ends, std::vector<MovingContender>& list) {
  for (const Variation& transport : transports) {
    for (const Variation& end : ends) {
      MovingContender next = contender(scene, transport.name + end.name, transport.json);
      settings_from_json(describe(next.settings), end.json, next.name);
      if (is_candidate(next.name)) next.repetitions = kManyRepetitions;
      list.push_back(std::move(next));
    }
  }
}

/// Presets, then combinations. `interactive` comes first: the time of its frames is the common budget.
std::vector<MovingContender> contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<MovingContender> list{contender(scene, kInteractive, require_preset(kInteractive).json)};
  for (const char* name : kPapers) list.push_back(contender(scene, name, require_preset(name).json));
  for (MovingContender& preset : list) preset.repetitions = context.choose(kManyRepetitions, 2);
  if (context.quick) return list;
  append_products(scene, kTransports, kEnds, list);
  append_products(scene, kTodays, kTodaysEnds, list);
  for (const Variation& single : kSingles) list.push_back(contender(scene, single.name, single.json));
  return list;
}

/// Geometric mean over the scenes of each contender's MSE over the lowest MSE.
std::vector<double> distances_to_best(const std::vector<MovingErrors>& scenes) {
  std::vector<double> logs(scenes.front().contenders.size(), 0);
  for (const MovingErrors& scene : scenes) {
    double least = scene.contenders.front().mse;
    for (const MovingError& e : scene.contenders) least = std::min(least, e.mse);
    for (size_t i = 0; i < logs.size(); ++i)
      logs[i] += std::log(scene.contenders[i].mse / least) / static_cast<double>(scenes.size());
  }
  for (double& value : logs) value = std::exp(value);
  return logs;
}

TableBlock table(const std::vector<MovingErrors>& scenes) {
  TableBlock block{"Combinations",
                   "MSE of the displayed image while the camera turns, at equal time, with FLIP, the number of frames "
                   "and their share of the time. Only whole frames count, so a slow technique may use up to 50 % more "
                   "or less time. The first column is the geometric mean of the MSE over the lowest in each scene.",
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
    const Ratio ratio = error_ratio(named(scene.contenders, "contender", name).mses,
                                    named(scene.contenders, "contender", kInteractive).mses);
    log_value += std::log(ratio.value) / static_cast<double>(scenes.size());
    squared_spread += sqr(std::log(ratio.interval.high / ratio.value) / static_cast<double>(scenes.size()));
  }
  const double value = std::exp(log_value);
  const double spread = std::exp(std::sqrt(squared_spread));
  return {value, {value / spread, value * spread, 0.95}};
}

Claim claim_choice(const std::vector<MovingErrors>& scenes) {
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
  return judged_ratios("best-choice", kOurs, "No candidate has 10 % less error than `interactive`, over all scenes.",
                       measured, ratios, 0.9);
}

ImageSet images(const MovingErrors& scene) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i <= std::size(kPapers); ++i) {
    const MovingError& e = scene.contenders[i];
    images.push_back({e.name, static_cast<int>(i), &e.last, fmt::format("mean MSE {:.2e}", e.mse)});
  }
  return measured_set(scene.scene, scene.reference, images, {.values = false});
}

ExperimentResult run_interactive(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{at_rest(built_in("cornell", 6)), at_rest(built_in("corridor", 6)),
                                    learning_scene("warehouse"), learning_scene("mine")};
  if (std::optional<ExperimentScene> hall = sponza(context)) list.insert(list.begin(), std::move(*hall));
  const MovingOptions options{.frames = context.choose(12, 3),
                              .repetitions = context.choose(kRepetitions, 1),
                              .reference_spp = context.choose(1024, 16)};
  std::vector<MovingErrors> scenes;
  for (const ExperimentScene& scene : list)
    scenes.push_back(measure_moving(context, scene, contenders(context, scene), options));

  ExperimentResult result;
  for (const MovingErrors& scene : scenes) result.claims.push_back(claim_scene(scene));
  if (context.scene_folder.empty()) {
    result.claims.push_back(unmeasured("beats-papers-sponza", kOurs,
                                       "Sponza: the preset `interactive` has less error than any single paper's, at "
                                       "equal time.",
                                       "every ratio above 1", kNoSponza));
  }
  if (!context.quick) result.claims.push_back(claim_choice(scenes));
  std::vector<ImageSet> sets;
  for (const MovingErrors& scene : scenes) sets.push_back(images(scene));
  result.blocks.emplace_back(table(scenes));
  result.blocks.emplace_back(ViewerBlock{"Images",
                                         "Displayed image at the last view, while the camera turns; with the mean MSE "
                                         "over both views and all repetitions.",
                                         image_layer_kinds(), std::move(sets)});
  result.setup = {
      {"Camera", fmt::format("turns by 10° from view to view; two views are measured, in each of {} repetitions ({} of "
                             "presets and of candidates for the preset)",
                             options.repetitions, context.choose(kManyRepetitions, 2))},
      {"Time", fmt::format("that of {} frames of `interactive` between views; a slow technique has fewer frames",
                           options.frames)},
      {"Bounces", "6; 2 in `warehouse` and `mine`"},
      {"Size", size_text(context)},
      {"Reference", fmt::format("{} samples per pixel by path tracing with the light tree; its own noise is known and "
                                "subtracted from MSE, not from FLIP",
                                options.reference_spp)}};
  return result;
}

}  // namespace

Experiment interactive_experiment() {
  return {kInteractive, kOurs, "combinations and presets at equal time, while the camera turns", run_interactive};
}

}  // namespace relume
