// [Lin22]: the error of ReSTIR PT by the shift of its paths, where glossy and diffuse surfaces mix: hybrid shifts
// against reconnection and random replay. [Lin26]: reciprocal pairs and the duplication map.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Lin22]";
constexpr const char* kEnhanced = "[Lin26]";
constexpr const char* kOurs = "[relume]";
constexpr const char* kPath = "path";
constexpr const char* kHybrid = "hybrid";
constexpr const char* kReconnection = "reconnection";
constexpr const char* kReplay = "replay";
constexpr const char* kPairs = "hybrid, reciprocal";

struct Variation {
  const char* name;
  const char* json;
};

constexpr Variation kContenders[] = {
    {kPath, R"({"reuse": "none"})"},
    {kReconnection, R"({"reuse": "restir-pt", "restir-pt.shift": "reconnection"})"},
    {kReplay, R"({"reuse": "restir-pt", "restir-pt.shift": "replay"})"},
    {kHybrid, R"({"reuse": "restir-pt", "restir-pt.shift": "hybrid"})"},
    {"hybrid, 2022", R"({"reuse": "restir-pt", "restir-pt.shift": "hybrid", "restir-pt.connect": "distance-2022"})"},
    {kPairs, R"({"reuse": "restir-pt", "restir-pt.reciprocal": true})"},
    {"hybrid, duplication", R"({"reuse": "restir-pt", "restir-pt.duplication": 0.8})"},
    {"hybrid, constant", R"({"reuse": "restir-pt", "restir-pt.correction": "constant"})"},
    {"restir-gi", R"({"reuse": "restir-gi"})"},
};

struct SceneResult {
  std::string name;
  double noise = 0;  ///< of the reference
  std::vector<AdaptedError> errors;
  ImageSet images;

  const AdaptedError& of(std::string_view contender) const { return named(errors, "contender", contender); }
};

std::vector<ExperimentScene> scenes(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{built_in("cornell-mirror", 6)};
  if (context.quick) return list;
  list.push_back(built_in("cornell-spheres", 6));
  list.push_back(closed_box(BoxVariation::reflective));
  list.push_back(built_in("door", 6));
  return list;
}

std::vector<NamedSettings> contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<NamedSettings> list;
  for (const Variation& variation : kContenders) {
    NamedSettings next{variation.name, scene.settings};
    settings_from_json(describe(next.settings), variation.json, next.name);
    set_size_and_device(context, next.settings, scene.scale);
    list.push_back(std::move(next));
  }
  return list;
}

/// Histories reach their cap of 20 frames within the warm-up.
AdaptedOptions options(const ExperimentContext& context) {
  return {.warm_up = context.choose(48, 3),
          .frames = context.choose(24, 2),
          .sessions = context.choose(6, 2),
          .block = context.choose(24, 2)};
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, scene, context.choose(2048, 16));
  const PixelMask all = mask_of({"image"}, reference.image.width, reference.image.height);
  SceneResult result{scene.name, reference_noise(reference, all), {}, {}};
  result.errors = measure_adapted(context, scene, contenders(context, scene), reference, {all}, options(context));
  result.images = adapted_images(scene.name, result.errors, reference.image);
  return result;
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{scene.name,
                   fmt::format("Mean squared error of single frames, and how many times lower it is than that of path "
                               "tracing: at equal samples, and times the frame time, with 95 % intervals. The "
                               "reference's own ({:.1e}) is subtracted. Rays are those of paths, shifts and shadows.",
                               scene.noise),
                   "shifts",
                   {{"MSE", "", Better::lower},
                    {"ms per frame", "", Better::lower},
                    {"rays per pixel", "", Better::lower},
                    {"times lower than path", "", Better::higher},
                    {"times time", "", Better::higher}},
                   {}};
  int color = 0;
  for (const AdaptedError& e : scene.errors) {
    const Ratio ratio = error_ratio(scene.of(kPath).mse[0], e.mse[0]);
    const Ratio time = equal_time_ratio(scene.of(kPath), e);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {fmt::format("{:.2f}", e.rays), e.rays},
                           {to_text(ratio), ratio.value},
                           {to_text(time), time.value}}});
  }
  return block;
}

/// Claims that hybrid shifts have less MSE than another contender, in each scene.
Claim claim_less(const std::vector<SceneResult>& all, const char* id, const char* paper, const std::string& text,
                 const char* other) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : all) {
    ratios.push_back(error_ratio(scene.of(other).mse[0], scene.of(kHybrid).mse[0]));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : "; ", scene.name, to_text(ratios.back()));
  }
  return judged_ratios(id, paper, text, measured, ratios, 1);
}

/// Claims that one contender has less MSE times frame time than another, in each scene.
Claim claim_less_at_equal_time(const std::vector<SceneResult>& all, const char* id, const char* paper,
                               const std::string& text, const char* less, const char* other) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : all) {
    ratios.push_back(equal_time_ratio(scene.of(other), scene.of(less)));
    measured += fmt::format("{}{} {} with {:.1f} rays per pixel against {:.1f}", measured.empty() ? "" : "; ",
                            scene.name, to_text(ratios.back()), scene.of(less).rays, scene.of(other).rays);
  }
  return judged_ratios(id, paper, text, measured, ratios, 1);
}

ExperimentResult run_restir_pt_shifts(const ExperimentContext& context) {
  std::vector<SceneResult> all;
  for (const ExperimentScene& scene : scenes(context)) all.push_back(measure(context, scene));
  ExperimentResult result;
  result.claims.push_back(claim_less(all, "reconnection", kPaper,
                                     "Frames with hybrid shifts have less MSE than with reconnection.", kReconnection));
  result.claims.push_back(
      claim_less(all, "replay", kPaper, "Frames with hybrid shifts have less MSE than with random replay.", kReplay));
  result.claims.push_back(claim_less_at_equal_time(
      all, "path-time", kOurs, "Hybrid shifts have less MSE times time than path tracing.", kHybrid, kPath));
  result.claims.push_back(claim_less_at_equal_time(
      all, "restir-gi-time", kOurs, "Hybrid shifts have less MSE times time than restir-gi.", kHybrid, "restir-gi"));
  result.claims.push_back(claim_less_at_equal_time(
      all, "reciprocal-time", kEnhanced,
      "Reciprocal pairs of neighbours have less MSE times time than neighbours of each pixel's own.", kPairs, kHybrid));
  std::vector<ImageSet> images;
  for (SceneResult& scene : all) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : all) result.blocks.emplace_back(table(scene));
  const AdaptedOptions o = options(context);
  result.setup = {
      {"Size", size_text(context)},
      {"Bounces", "6"},
      {"Frames", fmt::format("{} sessions with separate seeds, {} frames before {} measured ones", o.sessions,
                             o.warm_up, o.frames)},
      {"Intervals", "95 %, from means of sessions; of blocks for path tracing"},
      {"Times",
       "contenders take turns frame by frame; MSE times time is the result at equal time if errors fall with "
       "one over time"},
      {"Reference",
       fmt::format("{} samples per pixel; its own noise is known and subtracted", context.choose(2048, 16))}};
  return result;
}

}  // namespace

Experiment restir_pt_shifts_experiment() {
  return {"restir-pt-shifts", kPaper, "ReSTIR PT by its shifts: reconnection, replay, and their hybrid",
          run_restir_pt_shifts};
}

}  // namespace relume
