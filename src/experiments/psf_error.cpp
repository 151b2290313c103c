// [Schipek22 §6.1], figures 6.1 to 6.4: the error of frames of one sample a pixel, with and without what earlier frames
// know.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/study.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/references.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";

/// Caches show single frames and what their cells know; "accumulated" is path tracing with a history.
constexpr const char* kContenders =
    "path=cache:none,history:none,accumulated=cache:none,history:accumulate,psf=cache:psf,history:none,"
    "psf-no-edge-rays=cache:psf,history:none,psf.edge-rays:0,"
    "psf-accumulated=cache:psf,history:accumulate,apsf=cache:apsf,history:none,apg=cache:apg,history:none,"
    "apg+apsf=cache:apsf+apg,history:none";

double error_at(const Comparison& c, std::string_view name, uint32_t frames) {
  const ContenderResult& contender = contender_named(c, name);
  return median_of(contender, [&](const Repetition& r) {
    for (const ErrorPoint& p : r.curve) {
      if (p.frames >= frames) return p.mse;
    }
    return r.mse;
  });
}

/// Largest ratio of the MSE of `a` over that of `b` in frames `first` to `last`.
double worst_ratio(const Comparison& c, std::string_view a, std::string_view b, uint32_t first, uint32_t last) {
  double worst = 0;
  for (uint32_t frame = first; frame <= last; ++frame)
    worst = std::max(worst, error_at(c, a, frame) / error_at(c, b, frame));
  return worst;
}

void claim_first_frame(const Comparison& c, std::vector<Claim>& claims) {
  const double ratio = error_at(c, "psf", 1) / error_at(c, "path", 1);
  claims.push_back(judged("first-frame-" + c.options.scene_name, kPaper,
                          fmt::format("{}: one sample a pixel and no history, psf at least halves the MSE of path "
                                      "tracing.",
                                      c.options.scene_name),
                          fmt::format("{:.3f} of path tracing's", ratio), "at most 0.5", ratio <= 0.5));
}

/// MSE of first frames, over all pixels and over those away from lamps.
struct FirstFrames {
  double all = 0;
  double away = 0;
};

FirstFrames first_frames(const ExperimentContext& context, const ExperimentScene& scene, const RenderSettings& settings,
                         const Image& reference, const PixelMask& surfaces) {
  const int count = context.choose(16, 4);
  const PixelMask all = mask_of({"picture"}, reference.width, reference.height);
  Session session(scene.scene, settings);
  session.set_camera(scene.camera);
  FirstFrames means;
  for (int seed = 1; seed <= count; ++seed) {
    context.check_stop();
    session.restart(seed);
    session.render_frame();
    const Image image = session.image();
    means.all += frame_mse(image, reference, all) / count;
    means.away += frame_mse(image, reference, surfaces) / count;
  }
  return means;
}

/// Which part of the gain comes from the filter, and which from the camera rays at edges of lamps.
void claim_filter_alone(const ExperimentContext& context, const ExperimentScene& scene, std::vector<Claim>& claims) {
  const Reference reference = make_reference(context, scene);
  const PixelMask surfaces = surfaces_of(context, scene);
  const std::vector<NamedSettings> contenders = cache_contenders(context, scene);
  RenderSettings settings = contenders[1].settings;
  const FirstFrames path = first_frames(context, scene, contenders[0].settings, reference.image, surfaces);
  const FirstFrames psf = first_frames(context, scene, settings, reference.image, surfaces);
  settings.psf.edge_rays = 0;
  const FirstFrames plain = first_frames(context, scene, settings, reference.image, surfaces);
  claims.push_back(judged(
      "first-frame-filter-" + scene.name, kPaper,
      fmt::format("{}: away from lamps, where it traces no camera rays of its own, psf at least halves the MSE of path "
                  "tracing too.",
                  scene.name),
      fmt::format("{:.3f} of path tracing's MSE without the pixels at lamps ({:.3f} with psf.edge-rays 0); of whole "
                  "pictures {:.3f}, and {:.3f} with psf.edge-rays 0",
                  psf.away / path.away, plain.away / path.away, psf.all / path.all, plain.all / path.all),
      "at most 0.5", psf.away <= 0.5 * path.away));
}

void claim_accumulation(const Comparison& c, std::vector<Claim>& claims) {
  const double cells = worst_ratio(c, "psf", "accumulated", 1, 8);
  const double both = worst_ratio(c, "psf-accumulated", "accumulated", 1, 8);
  claims.push_back(
      judged("first-frames-" + c.options.scene_name, kPaper,
             fmt::format("{}: with a history, psf stays below plain accumulation for at least eight "
                         "frames.",
                         c.options.scene_name),
             fmt::format("at most {:.2f} of accumulation's MSE ({:.2f} with no history but the cells')", both, cells),
             "below 1", both < 1));
}

void claim_similar(const Comparison& c, std::vector<Claim>& claims) {
  const double apsf = error_at(c, "apsf", 16) / error_at(c, "psf", 16);
  const double apg = error_at(c, "apg", 16) / error_at(c, "psf", 16);
  claims.push_back(judged("adaptive-" + c.options.scene_name, kPaper,
                          fmt::format("{}: the adaptive techniques have roughly the MSE of psf.", c.options.scene_name),
                          fmt::format("after 16 frames: apsf {:.2f}, apg {:.2f} of psf's", apsf, apg),
                          "apsf at most 1.1, apg at most 2", apsf <= 1.1 && apg <= 2));
}

/// Figure 6.4: along the camera path of a scene.
void measure_walk(const ExperimentContext& context, const char* name, int bounces, ExperimentResult& result) {
  const Comparison c = study(context, built_in(name, bounces),
                             {.techniques = kContenders,
                              .spp = 1,
                              .times_s = frame_times(context.choose(12, 3)),
                              .repetitions = 3,
                              .reference_spp = context.choose(128, 64)});
  const double psf = mse_of(c, "psf") / mse_of(c, "path");
  const double apsf = mse_of(c, "apsf") / mse_of(c, "path");
  result.claims.push_back(judged(fmt::format("walk-{}", name), kPaper,
                                 fmt::format("{}, moving camera: filtered frames have less error than those of path "
                                             "tracing.",
                                             name),
                                 fmt::format("psf {:.3f}, apsf {:.3f} of path tracing's", psf, apsf), "both below 1",
                                 std::max(psf, apsf) < 1));
  const std::vector<Block> blocks = study_blocks(fmt::format("{}, moving camera", name), c);
  result.blocks.insert(result.blocks.end(), blocks.begin(), blocks.end());
}

ExperimentResult run_psf_error(const ExperimentContext& context) {
  ExperimentResult result;
  for (const ExperimentScene& scene : cache_scenes(context)) {
    const Comparison c =
        study(context, scene, {.techniques = kContenders, .spp = context.choose(24, 16), .repetitions = 5});
    if (scene.name == "cornell" || scene.name == "Sponza") {
      claim_first_frame(c, result.claims);
      claim_filter_alone(context, scene, result.claims);
      claim_accumulation(c, result.claims);
    }
    claim_similar(c, result.claims);
    const std::vector<Block> blocks = study_blocks(scene.name, c);
    result.blocks.insert(result.blocks.end(), blocks.begin(), blocks.end());
  }
  claim_without_sponza(
      context, kPaper,
      {{"first-frame-Sponza", "Sponza: one sample a pixel and no history, psf at least halves the MSE of path tracing.",
        "at most 0.5"},
       {"first-frame-filter-Sponza", "Sponza: away from lamps, psf at least halves the MSE of path tracing too.",
        "at most 0.5"},
       {"first-frames-Sponza", "Sponza: with a history, psf stays below plain accumulation for at least eight frames.",
        "below 1"},
       {"adaptive-Sponza", "Sponza: the adaptive techniques have roughly the MSE of psf.",
        "apsf at most 1.1, apg at most 2"}},
      result.claims);
  measure_walk(context, "corridor", 10, result);
  result.setup = {common_setup(context).front(),
                  {"Samples", "1 a pixel and frame"},
                  {"Bounces", "6; corridor: 10"},
                  {"Settings", "the defaults of each technique"},
                  {"Repetitions", "median of 5; of the walk, 3"}};
  return result;
}

}  // namespace

Experiment psf_error_experiment() {
  return {"psf-error", kPaper, "one sample a pixel: what filters in path space do to the error", run_psf_error};
}

}  // namespace relume
