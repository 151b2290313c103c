// [Ouyang21]: indirect light by path tracing, guiding, caches and reservoirs, in frames of one sample and at equal
// time. Rays per pixel stand beside the times, since the two differ by processor.
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adapted_error.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/study.h"
#include "experiments/setup/apply_settings.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "report/images.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Ouyang21]";
constexpr const char* kOurs = "[relume]";
constexpr const char* kPath = "path";
constexpr const char* kReuse = "restir-gi";

constexpr double kLeastGain = 9.3;  ///< least of the abstract: 9.3 to 166 times less MSE with one sample per pixel
constexpr double kMostRays = 8;     ///< beyond path tracing's: 2 + 2 · restir-gi.neighbours

/// Truncated paths would count as an error of caches that gather the light of any number of bounces.
constexpr int kBounces = 16;
constexpr double kEqualTime_s = 2;

enum class Origin { none, seed, today };

struct Technique {
  const char* name;
  const char* settings;
  Origin origin = Origin::none;
};

constexpr Technique kTechniques[] = {
    {kPath, "reuse:none"},
    {"cdq", "guide:cdq", Origin::seed},
    {"apg", "cache:apg", Origin::seed},
    {"sharc", "cache:sharc", Origin::today},
    {kReuse, "reuse:restir-gi", Origin::today},
    {"mcpg", "guide:mcpg", Origin::today},
    {"restir-pt", "reuse:restir-pt", Origin::today},
    {"restir-gi-basic", "reuse:restir-gi,restir-gi.correction:basic,restir-gi.reuse-glossy:true"},
};

struct SceneResult {
  std::string name;
  double noise = 0;  ///< of the reference of `frames`
  std::vector<AdaptedError> frames;
  Comparison still;
  ImageSet images;

  const AdaptedError& of(std::string_view technique) const { return named(frames, "contender", technique); }
};

/// Reservoirs reach their cap of 20 frames, and cells their 32 frames, within the warm-up.
AdaptedOptions options(const ExperimentContext& context) {
  return {.warm_up = context.choose(48, 4),
          .frames = context.choose(24, 2),
          .sessions = context.choose(4, 2),
          .block = context.choose(24, 2)};
}

int reference_spp(const ExperimentContext& context) { return context.choose(1024, 16); }

/// Scenes that are lit indirectly. A quick run has the first, which compiles fast.
std::vector<ExperimentScene> scenes(const ExperimentContext& context) {
  std::vector<ExperimentScene> list{at_rest(built_in("corridor", kBounces))};
  if (!context.quick) {
    for (const char* name : {"mine", "door", "skylight"}) list.push_back(at_rest(built_in(name, kBounces)));
  }
  if (std::optional<ExperimentScene> hall = sponza(context)) {
    hall->settings.path.max_bounces = kBounces;
    list.push_back(std::move(*hall));
  }
  return list;
}

std::vector<NamedSettings> contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<NamedSettings> list;
  for (const Technique& technique : kTechniques) {
    NamedSettings next{technique.name, scene.settings};
    apply_settings(technique.settings, technique.name, next.settings);
    set_size_and_device(context, next.settings, scene.scale);
    list.push_back(std::move(next));
  }
  return list;
}

StudyOptions still_options() {
  StudyOptions result{.techniques = {}, .budget_s = kEqualTime_s, .repetitions = 6, .reference_spp = 1024};
  for (const Technique& technique : kTechniques)
    result.techniques +=
        fmt::format("{}{}={}", result.techniques.empty() ? "" : ",", technique.name, technique.settings);
  result.reference.emplace_back("lights", "light-tree");
  return result;
}

SceneResult measure(const ExperimentContext& context, const ExperimentScene& scene) {
  const Reference reference = make_reference(context, plainly_sampled(scene), reference_spp(context));
  const PixelMask surfaces = surfaces_of(context, scene);
  SceneResult result{scene.name, reference_noise(reference, surfaces), {}, {}, {}};
  result.frames = measure_adapted(context, scene, contenders(context, scene), reference, {surfaces}, options(context));
  result.still = study(context, scene, still_options());
  result.images = adapted_images(scene.name, result.frames, reference.image);
  return result;
}

/// MSE of the accumulated image per repetition, without the reference's noise.
std::vector<double> still_errors(const SceneResult& scene, std::string_view name) {
  return values_of(contender_named(scene.still, name),
                   [&](const Repetition& r) { return r.mse - scene.still.reference_noise.mse; });
}

Ratio still_gain(const SceneResult& scene, std::string_view worse, std::string_view better) {
  return error_ratio(still_errors(scene, worse), still_errors(scene, better));
}

/// The technique of this origin with the least error at equal time.
const Technique& best(const SceneResult& scene, Origin origin) {
  const Technique* least = nullptr;
  double error = 0;
  for (const Technique& technique : kTechniques) {
    if (technique.origin != origin) continue;
    const double own = mean(still_errors(scene, technique.name));
    if (!least || own < error) {
      least = &technique;
      error = own;
    }
  }
  return *least;
}

std::string frames_text(const std::string& scene) {
  return fmt::format("{}: with one sample per pixel, path tracing has at least {} times the MSE of restir-gi.", scene,
                     kLeastGain);
}
std::string time_text(const std::string& scene) {
  return scene + ": at equal time, restir-gi has less error than path tracing.";
}
std::string today_text(const std::string& scene) {
  return scene +
         ": at equal time, the best of the techniques of real-time engines has less error than the best of "
         "cdq and apg.";
}

Claim claim_frames(const SceneResult& scene, const std::string& id) {
  const AdaptedError& path = scene.of(kPath);
  const AdaptedError& reuse = scene.of(kReuse);
  const Ratio ratio = error_ratio(path.mse[0], reuse.mse[0]);
  const std::string measured =
      fmt::format("{} the MSE, {} the MSE times frame time, {:.1f} rays per pixel against {:.1f}", to_text(ratio),
                  to_text(equal_time_ratio(path, reuse)), path.rays, reuse.rays);
  return judged_ratios(id, kPaper, frames_text(scene.name), measured, {ratio}, kLeastGain);
}

Claim claim_time(const SceneResult& scene, const std::string& id) {
  const Ratio ratio = still_gain(scene, kPath, kReuse);
  return judged_ratios(id, kOurs, time_text(scene.name), "path tracing has " + to_text(ratio) + " its MSE", {ratio}, 1);
}

Claim claim_today(const SceneResult& scene, const std::string& id) {
  const Technique& seed = best(scene, Origin::seed);
  const Technique& today = best(scene, Origin::today);
  const Ratio ratio = still_gain(scene, seed.name, today.name);
  return judged_ratios(id, kOurs, today_text(scene.name),
                       fmt::format("{} has {} the MSE of {}", seed.name, to_text(ratio), today.name), {ratio}, 1);
}

Claim claim_rays(const std::vector<SceneResult>& list) {
  std::string measured;
  bool holds = true;
  for (const SceneResult& scene : list) {
    const double more = scene.of(kReuse).rays - scene.of(kPath).rays;
    holds = holds && more <= kMostRays;
    measured += fmt::format("{}{} {:.1f} more than {:.1f}", measured.empty() ? "" : ", ", scene.name, more,
                            scene.of(kPath).rays);
  }
  return judged("rays", kOurs, "The unbiased restir-gi traces at most two shadow rays per reservoir that it combines.",
                measured + " per pixel", fmt::format("at most {} more than path tracing in each scene", kMostRays),
                holds);
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
      fmt::format("Mean squared error of single frames where no lamp is visible, and how many times lower it is than "
                  "path tracing's: at equal samples, times the frame time, and times the rays, with 95 % intervals. "
                  "The reference's own ({:.1e}) is subtracted. Last: images that accumulate for the same time.",
                  scene.noise),
      "technique",
      {{"MSE", "", Better::lower},
       {"ms per frame", "", Better::lower},
       {"rays per pixel", "", Better::lower},
       {"times lower than path tracing", "", Better::higher},
       {"times time", "", Better::higher},
       {"times rays", "", Better::higher},
       {"accumulated, equal time", "", Better::higher}},
      {}};
  int color = 0;
  for (const AdaptedError& e : scene.frames) {
    const Ratio ratio = error_ratio(scene.of(kPath).mse[0], e.mse[0]);
    const Ratio time = equal_time_ratio(scene.of(kPath), e);
    const Ratio rays = equal_rays_ratio(scene.of(kPath), e);
    const Ratio still = still_gain(scene, kPath, e.name);
    block.rows.push_back({e.name,
                          color++,
                          {{fmt::format("{:.3e}", e.mean_mse()), e.mean_mse()},
                           {fmt::format("{:.1f}", 1000 * e.median_s()), e.median_s()},
                           {fmt::format("{:.2f}", e.rays), e.rays},
                           {to_text(ratio), ratio.value},
                           {to_text(time), time.value},
                           {to_text(rays), rays.value},
                           {to_text(still), still.value}}});
  }
  return block;
}

std::vector<std::pair<std::string, std::string>> setup(const ExperimentContext& context) {
  const AdaptedOptions o = options(context);
  return {{"Size", size_text(context)},
          {"Bounces", fmt::format("{}, with roulette", kBounces)},
          {"Frames", fmt::format("{} sessions with separate seeds, {} frames before {} measured ones; techniques "
                                 "without memory use one session",
                                 o.sessions, o.warm_up, o.frames)},
          {"Intervals", "95 %, from means of sessions for reservoirs and of blocks of frames for the others"},
          {"Accumulated", fmt::format("{} s per contender, alternately, six repetitions", kEqualTime_s)},
          {"Best techniques",
           "those with the least mean error in the same repetitions; intervals do not cover that choice"},
          {"Times",
           "contenders take turns frame by frame; MSE times time is the result at equal time if errors fall with one "
           "over time, as those of independent frames"},
          {"Reference", fmt::format("{} samples per pixel with the light tree; its own noise is known and subtracted",
                                    reference_spp(context))}};
}

/// "corridor", "sponza".
std::string id_of(const SceneResult& scene) { return scene.name == "Sponza" ? "sponza" : scene.name; }

ExperimentResult run_indirect(const ExperimentContext& context) {
  std::vector<SceneResult> results;
  for (const ExperimentScene& scene : scenes(context)) results.push_back(measure(context, scene));
  ExperimentResult result;
  for (const SceneResult& scene : results) {
    result.claims.push_back(claim_frames(scene, "frames-" + id_of(scene)));
    result.claims.push_back(claim_time(scene, "time-" + id_of(scene)));
    result.claims.push_back(claim_today(scene, "today-" + id_of(scene)));
  }
  claim_without_sponza(context, kPaper, {{"frames-sponza", frames_text("Sponza"), "at least 9.3×, by the interval"}},
                       result.claims);
  claim_without_sponza(context, kOurs,
                       {{"time-sponza", time_text("Sponza"), "at least 1×, by the interval"},
                        {"today-sponza", today_text("Sponza"), "at least 1×, by the interval"}},
                       result.claims);
  result.claims.push_back(claim_rays(results));
  std::vector<ImageSet> images;
  for (SceneResult& scene : results) images.push_back(std::move(scene.images));
  result.blocks.emplace_back(
      ViewerBlock{"Images", "One frame of one sample per pixel, adapted.", image_layer_kinds(), std::move(images)});
  for (const SceneResult& scene : results) result.blocks.emplace_back(table(scene));
  for (const SceneResult& scene : results) {
    for (Block& block : study_blocks(scene.name + ", equal time", scene.still)) {
      if (!std::holds_alternative<ViewerBlock>(block)) result.blocks.push_back(std::move(block));
    }
  }
  result.setup = setup(context);
  return result;
}

}  // namespace

Experiment indirect_experiment() {
  return {"indirect", kPaper, "indirect light by paths, guiding, caches and reservoirs at equal time", run_indirect};
}

}  // namespace relume
