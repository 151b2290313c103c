// [Bitterli20]: the error of direct light by ReSTIR DI at equal time, against light sampling and against resampling
// without reuse. Rays per pixel stand beside the times, since the two differ by processor.
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/study.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Bitterli20]";
constexpr const char* kOurs = "[relume]";
constexpr const char* kTree = "light-tree";
constexpr const char* kReuse = "restir-di";
constexpr const char* kBasic = "restir-di, basic";

/// Bounds of the abstract: the unbiased estimator reaches an error 6 to 60 times faster, the biased one 35 to 65 times.
constexpr double kLeastUnbiased = 6;
constexpr double kLeastBiased = 35;
constexpr double kMostRays = 8;

struct Variation {
  const char* name;
  const char* json;
};

constexpr Variation kContenders[] = {
    {"power", R"({"lights": "power"})"},
    {kTree, R"({"lights": "light-tree"})"},
    {"vlc", R"({"lights": "vlc"})"},
    {"neeat", R"({"lights": "neeat"})"},
    {"ris", R"({"reuse": "ris"})"},
    {kReuse, R"({"reuse": "restir-di"})"},
    {"restir-di, light-tree", R"({"reuse": "restir-di", "lights": "light-tree"})"},
    {"restir-di, vlc", R"({"reuse": "restir-di", "lights": "vlc"})"},
    {kBasic, R"({"reuse": "restir-di", "restir.correction": "basic", "restir.neighbours": 1, "restir.radius": 32})"},
};

struct SceneResult {
  std::string name;
  double noise = 0;  ///< of the reference
  std::vector<AdaptedError> errors;
  ImageSet images;

  const AdaptedError& of(std::string_view contender) const { return named(errors, "contender", contender); }
};

ExperimentScene lit_by(const char* name, int bounces) {
  ExperimentScene scene = learning_scene(name);
  scene.settings.path.max_bounces = bounces;
  if (bounces > 1) scene.name += fmt::format(", {} bounces", bounces);
  return scene;
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
  return {.warm_up = context.choose(48, 4),
          .frames = context.choose(24, 2),
          .sessions = context.choose(5, 2),
          .block = context.choose(24, 2)};
}

/// Scenes for direct light. The first is also measured with indirect light, and in still images.
std::vector<const char*> scene_names(const ExperimentContext& context) {
  if (context.quick) return {"cornell"};  // compiles fast
  return {"warehouse", "base-1", "base-2", "cover"};
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, plainly_sampled(scene), learning_reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  SceneResult result{scene.name, reference_noise(reference, surfaces), {}, {}};
  result.errors = measure_adapted(context, scene, contenders(context, scene), reference, {surfaces}, options(context));
  result.images = adapted_images(scene.name, result.errors, reference.image);
  return result;
}

/// Ratio of MSE times rays, a over b: the result at an equal number of rays, under the assumption of
/// equal_time_ratio().
Ratio equal_rays_ratio(const AdaptedError& a, const AdaptedError& b) {
  const double rays = a.rays / b.rays;
  return product(error_ratio(a.mse[0], b.mse[0]), {rays, {rays, rays, 1}});
}

TableBlock table(const SceneResult& scene) {
  TableBlock block{
      scene.name,
      fmt::format(
          "Mean squared error of single frames where no lamp is visible, and how many times lower it is than the "
          "light tree's: at equal samples, times the frame time, and times the rays, with 95 % intervals. The "
          "reference's own ({:.1e}) is subtracted. Rays are those of paths, shadows and reuse.",
          scene.noise),
      "lights",
      {{"MSE", "", Better::lower},
       {"ms per frame", "", Better::lower},
       {"rays per pixel", "", Better::lower},
       {"times lower than the light tree", "", Better::higher},
       {"times time", "", Better::higher},
       {"times rays", "", Better::higher}},
      {}};
  int color = 0;
  for (const AdaptedError& e : scene.errors) {
    const Ratio ratio = error_ratio(scene.of(kTree).mse[0], e.mse[0]);
    const Ratio time = equal_time_ratio(scene.of(kTree), e);
    const Ratio rays = equal_rays_ratio(scene.of(kTree), e);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {fmt::format("{:.2f}", e.rays), e.rays},
                           {to_text(ratio), ratio.value},
                           {to_text(time), time.value},
                           {to_text(rays), rays.value}}});
  }
  return block;
}

/// "10.3× (9.8 to 10.9) with 12 rays against 3".
std::string gain_text(const AdaptedError& a, const AdaptedError& b, const Ratio& ratio) {
  return fmt::format("{} with {:.1f} rays per pixel against {:.1f}", to_text(ratio), b.rays, a.rays);
}

/// Claims that a contender has at least `least` times less MSE times time than another, in each scene.
void claim_gain(const std::vector<SceneResult>& scenes, const char* id, const char* paper, const std::string& text,
                const char* worse, const char* better, double least, std::vector<Claim>& claims) {
  std::vector<Ratio> ratios;
  std::string measured;
  for (const SceneResult& scene : scenes) {
    ratios.push_back(equal_time_ratio(scene.of(worse), scene.of(better)));
    measured += fmt::format("{}{} {}", measured.empty() ? "" : "; ", scene.name,
                            gain_text(scene.of(worse), scene.of(better), ratios.back()));
  }
  claims.push_back(judged_ratios(id, paper, text, measured, ratios, least));
}

void claim_rays(const std::vector<SceneResult>& scenes, std::vector<Claim>& claims) {
  std::string measured;
  bool holds = true;
  for (const SceneResult& scene : scenes) {
    const double rays = scene.of(kBasic).rays;
    holds = holds && rays <= kMostRays;
    measured += fmt::format("{}{} {:.1f} ({:.1f} exact)", measured.empty() ? "" : ", ", scene.name, rays,
                            scene.of(kReuse).rays);
  }
  claims.push_back(judged("rays", kPaper, "The biased estimator traces at most eight rays per pixel.",
                          measured + " per pixel, with the path's own", "at most 8 in each scene", holds));
}

/// MSE of the accumulated image per repetition.
std::vector<double> still_errors(const Comparison& c, std::string_view name) {
  return values_of(contender_named(c, name), [&](const Repetition& r) { return r.mse - c.reference_noise.mse; });
}

Claim claim_still(const Comparison& c, const std::string& scene) {
  const Ratio ris = error_ratio(still_errors(c, "ris"), still_errors(c, kReuse));
  const Ratio vlc = error_ratio(still_errors(c, "vlc"), still_errors(c, kReuse));
  return judged_ratios("still", kOurs,
                       scene +
                           ": also in an image that accumulates for a fixed time, reuse has less error than "
                           "resampling alone and than vlc, although its frames depend on each other.",
                       fmt::format("less than ris by {}, than vlc by {}", to_text(ris), to_text(vlc)), {ris, vlc}, 1);
}

ExperimentResult run_restir_di_speed(const ExperimentContext& context) {
  std::vector<SceneResult> scenes;
  for (const char* name : scene_names(context)) scenes.push_back(measure(context, lit_by(name, 1)));
  const std::string first = scenes.front().name;
  const SceneResult all_light = measure(context, lit_by(first.c_str(), 2));
  StudyOptions still{.techniques =
                         "power=lights:power,light-tree=lights:light-tree,vlc=lights:vlc,ris=reuse:ris,"
                         "restir-di=reuse:restir-di",
                     .budget_s = 3,
                     .reference_spp = 1024};
  still.reference.emplace_back("lights", "light-tree");
  const Comparison accumulated = study(context, lit_by(first.c_str(), 1), still);

  ExperimentResult result;
  claim_gain(scenes, "unbiased", kPaper,
             "The unbiased estimator reaches the error of sampling by a light hierarchy at least 6 times sooner.",
             kTree, kReuse, kLeastUnbiased, result.claims);
  claim_gain(scenes, "biased", kPaper,
             "The biased estimator reaches the error of sampling by a light hierarchy at least 35 times sooner.", kTree,
             kBasic, kLeastBiased, result.claims);
  claim_gain(scenes, "power", kOurs, "restir-di has less MSE times time than sampling by power.", "power", kReuse, 1,
             result.claims);
  claim_gain(scenes, "ris", kOurs, "restir-di has less MSE times time than resampling without reuse.", "ris", kReuse, 1,
             result.claims);
  claim_gain(scenes, "vlc", kOurs, "restir-di has less MSE times time than the visibility light cache.", "vlc", kReuse,
             1, result.claims);
  claim_rays(scenes, result.claims);
  result.claims.push_back(claim_still(accumulated, first));
  std::vector<ImageSet> images;
  for (SceneResult& scene : scenes) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(ViewerBlock{"Images", "One frame of one sample per pixel, adapted: direct light.",
                                         image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : scenes) result.blocks.emplace_back(table(scene));
  result.blocks.emplace_back(table(all_light));
  for (Block& block : study_blocks(first + ", accumulated", accumulated)) {
    if (!std::holds_alternative<ViewerBlock>(block)) result.blocks.push_back(std::move(block));
  }
  const AdaptedOptions o = options(context);
  result.setup = {
      {"Size", size_text(context)},
      {"Light", "direct, except in the last table; candidates of reservoirs are chosen by power unless stated"},
      {"Frames", fmt::format("{} sessions with separate seeds, {} frames before {} measured ones; techniques without "
                             "memory use one session",
                             o.sessions, o.warm_up, o.frames)},
      {"Intervals", fmt::format("95 %, from means of {} frames: sessions of restir-di, blocks of the others", o.block)},
      {"Times",
       "contenders take turns frame by frame; MSE times time is the result at equal time if errors fall with "
       "one over time"},
      {"Reference", fmt::format("{} samples per pixel with the light tree; its own noise is known and subtracted",
                                learning_reference_spp(context))},
      {"Accumulated", context.quick ? "0.08 s per contender" : "3 s per contender, five repetitions"}};
  return result;
}

}  // namespace

Experiment restir_di_speed_experiment() {
  return {"restir-di-speed", kPaper, "reservoirs for direct light at equal time, with rays per pixel",
          run_restir_di_speed};
}

}  // namespace relume
