// [Schipek22 §6.1], figures 6.1 to 6.4: the error of frames of one sample a pixel, with and without what earlier frames
// know.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/frame_averages.h"
#include "experiments/study.h"
#include "experiments/trace.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";

/// Caches show single frames and what their cells know; "accumulated" is path tracing with a history.
constexpr const char* kContenders =
    "path=cache:none,history:none,accumulated=cache:none,history:accumulate,psf=cache:psf,history:none,"
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
      claim_accumulation(c, result.claims);
    }
    claim_similar(c, result.claims);
    const std::vector<Block> blocks = study_blocks(scene.name, c);
    result.blocks.insert(result.blocks.end(), blocks.begin(), blocks.end());
  }
  if (context.scene_folder.empty()) {
    result.claims.push_back(unmeasured("first-frame-Sponza", kPaper,
                                       "Sponza: one sample a pixel and no history, psf at least halves the MSE of path "
                                       "tracing.",
                                       "at most 0.5", kNoSponza));
  }
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
