// Whether samples need to be reused before a denoiser: resampling alone against ReSTIR DI, both denoised, while the
// camera turns.
#include <algorithm>
#include <cctype>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/moving_error.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr const char* kWithout = "ris, svgf";
constexpr const char* kWith = "restir-di, svgf";

struct Variation {
  const char* name;
  const char* json;
  bool reuses = false;  ///< samples of other pixels or frames
};

/// The first determines the time between views.
constexpr Variation kContenders[] = {
    {kWithout, R"({"reuse": "ris", "denoise": "svgf"})"},
    {"ris, vlc, svgf", R"({"reuse": "ris", "lights": "vlc", "denoise": "svgf"})"},
    {"vlc, svgf", R"({"lights": "vlc", "denoise": "svgf"})"},
    {kWith, R"({"reuse": "restir-di", "denoise": "svgf"})", true},
    {"restir-di, vlc, svgf", R"({"reuse": "restir-di", "lights": "vlc", "denoise": "svgf"})", true},
    {"restir-di, basic, svgf", R"({"reuse": "restir-di", "restir.correction": "basic", "denoise": "svgf"})", true},
    {"restir-di, cap 5, svgf", R"({"reuse": "restir-di", "restir.cap": 5, "denoise": "svgf"})", true},
    {"restir-gi, svgf", R"({"reuse": "restir-gi", "denoise": "svgf"})", true},
    {"restir-di+gi, svgf", R"({"reuse": "restir-di+gi", "denoise": "svgf"})", true},
    {"restir-pt, svgf", R"({"reuse": "restir-pt", "denoise": "svgf"})", true},
    {"ris", R"({"reuse": "ris", "history": "none"})"},
    {"restir-di", R"({"reuse": "restir-di", "history": "none"})", true},
};

bool is_denoised(const Variation& variation) { return std::string_view(variation.name).ends_with("svgf"); }

std::vector<MovingContender> contenders(const ExperimentScene& scene) {
  std::vector<MovingContender> list;
  for (const Variation& variation : kContenders) {
    MovingContender next{.name = variation.name, .settings = scene.settings};
    settings_from_json(describe(next.settings), variation.json, next.name);
    list.push_back(std::move(next));
  }
  return list;
}

std::string id_of(const char* prefix, const MovingErrors& scene) {
  std::string id = fmt::format("{}-{}", prefix, scene.scene.substr(0, scene.scene.find(',')));
  std::transform(id.begin(), id.end(), id.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return id;
}

const MovingError& of(const MovingErrors& scene, std::string_view name) {
  return named(scene.contenders, "contender", name);
}

/// The contender with the least MSE among those that are denoised and reuse samples, or do not.
const MovingError& best(const MovingErrors& scene, bool reuses) {
  const MovingError* least = nullptr;
  for (const Variation& variation : kContenders) {
    if (variation.reuses != reuses || !is_denoised(variation)) continue;
    const MovingError& e = of(scene, variation.name);
    if (!least || e.mse < least->mse) least = &e;
  }
  return *least;
}

std::string gain_text(const MovingError& a, const MovingError& b) {
  return fmt::format("{}: {} less MSE than {}, {} less FLIP; in {:.0f} and {:.0f} % of the time", b.name,
                     to_text(error_ratio(a.mses, b.mses)), a.name, to_text(error_ratio(a.flips, b.flips)),
                     100 * b.time_share, 100 * a.time_share);
}

std::string reuse_text(const std::string& scene) {
  return scene + ": with SVGF, restir-di has less error than ris at equal time.";
}

Claim claim_reuse(const MovingErrors& scene) {
  const MovingError& without = of(scene, kWithout);
  const MovingError& with = of(scene, kWith);
  return judged_ratios(id_of("reuse", scene), kOurs, reuse_text(scene.scene), gain_text(without, with),
                       {error_ratio(without.mses, with.mses)}, 1);
}

std::string best_text(const std::string& scene) {
  return scene + ": with SVGF, the best contender that reuses samples has less error than the best that does not.";
}

Claim claim_best(const MovingErrors& scene) {
  const MovingError& without = best(scene, false);
  const MovingError& with = best(scene, true);
  return judged_ratios(id_of("best", scene), kOurs, best_text(scene.scene), gain_text(without, with),
                       {error_ratio(without.mses, with.mses)}, 1);
}

/// How much of the gain of reuse a denoiser leaves: errors of reused samples are blotches, which it removes less.
Claim claim_denoised(const std::vector<MovingErrors>& scenes) {
  std::string measured;
  std::vector<Ratio> shares;
  for (const MovingErrors& scene : scenes) {
    const Ratio noisy = error_ratio(of(scene, "ris").mses, of(scene, "restir-di").mses);
    const Ratio denoised = error_ratio(of(scene, kWithout).mses, of(scene, kWith).mses);
    shares.push_back(quotient(denoised, noisy));
    measured += fmt::format("{}{} {} before and {} after SVGF", measured.empty() ? "" : "; ", scene.scene,
                            to_text(noisy), to_text(denoised));
  }
  return judged_within("denoised", kOurs, "Denoising leaves less of the gain of reuse than single frames show.",
                       measured, "gain after over gain before below 1", shares, 0, 1);
}

TableBlock table(const MovingErrors& scene) {
  TableBlock block{scene.scene,
                   "Displayed image while the camera turns, at equal time: only whole frames count.",
                   "techniques",
                   {{"MSE", "", Better::lower},
                    {"less than ris, svgf", "", Better::higher},
                    {"FLIP", "", Better::lower},
                    {"frames per view", "", Better::none},
                    {"share of the time", "", Better::none}},
                   {}};
  int color = 0;
  for (const MovingError& e : scene.contenders) {
    const Ratio ratio = error_ratio(of(scene, kWithout).mses, e.mses);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mse), e.mse},
                           {to_text(ratio), ratio.value},
                           {fmt::format("{:.3f}", e.flip), e.flip},
                           {fmt::format("{}", e.frames), static_cast<double>(e.frames)},
                           {fmt::format("{:.0f} %", 100 * e.time_share), e.time_share}}});
  }
  return block;
}

ImageSet images(const MovingErrors& scene) {
  std::vector<MeasuredImage> list;
  int color = 0;
  for (const MovingError& e : scene.contenders)
    list.push_back({e.name, color++, &e.last, fmt::format("mean MSE {:.2e}", e.mse)});
  return measured_set(scene.scene, scene.reference, list, {.values = false});
}

ExperimentResult run_no_reuse(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{learning_scene("warehouse")};
  if (!context.quick) {
    for (const char* name : {"base-1", "cover"}) list.push_back(learning_scene(name));
  }
  if (std::optional<ExperimentScene> hall = sponza_with_lamps(context)) list.push_back(std::move(*hall));
  const MovingOptions options{
      .frames = context.choose(12, 3), .repetitions = context.choose(8, 2), .reference_spp = context.choose(512, 16)};
  std::vector<MovingErrors> scenes;
  for (const ExperimentScene& scene : list)
    scenes.push_back(measure_moving(context, scene, contenders(scene), options));

  ExperimentResult result;
  for (const MovingErrors& scene : scenes) result.claims.push_back(claim_reuse(scene));
  for (const MovingErrors& scene : scenes) result.claims.push_back(claim_best(scene));
  constexpr const char* kThreshold = "at least 1×, by the interval";
  claim_without_sponza(context, kOurs,
                       {{"reuse-sponza", reuse_text("Sponza, 200 lamps"), kThreshold},
                        {"best-sponza", best_text("Sponza, 200 lamps"), kThreshold}},
                       result.claims);
  result.claims.push_back(claim_denoised(scenes));
  std::vector<ImageSet> sets;
  for (const MovingErrors& scene : scenes) {
    result.blocks.emplace_back(table(scene));
    sets.push_back(images(scene));
  }
  result.blocks.emplace_back(ViewerBlock{"Images", "Displayed image at the last view, while the camera turns.",
                                         image_layer_kinds(), std::move(sets)});
  result.setup = {
      {"Camera", fmt::format("turns by 10° from view to view; two views are measured, in each of {} repetitions",
                             options.repetitions)},
      {"Time", fmt::format("that of {} frames of `{}` between views; others have fewer or more frames", options.frames,
                           kWithout)},
      {"Bounces", "2"},
      {"Size", size_text(context)},
      {"Reference", fmt::format("{} samples per pixel by path tracing with the light tree; its own noise is known and "
                                "subtracted from MSE, not from FLIP",
                                options.reference_spp)}};
  return result;
}

}  // namespace

Experiment no_reuse_experiment() {
  return {"no-reuse", kOurs, "resampling with and without reuse before a denoiser, while the camera turns",
          run_no_reuse};
}

}  // namespace relume
