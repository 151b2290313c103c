// [Schipek22 §6.1], figures 6.1 to 6.4: measures the error of one-sample frames, with and without cells from earlier
// frames.
#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/study.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "experiments/shared_parts.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";
constexpr const char* kOurs = "[relume]";

/// Caches display single frames filtered with their cells; "accumulated" is path tracing with a history. Every path
/// feeds the cells of path graphs, as in the thesis.
constexpr const char* kContenders =
    "path=cache:none,history:none,accumulated=cache:none,history:accumulate,psf=cache:psf,history:none,"
    "psf-no-edge-rays=cache:psf,history:none,psf.edge-rays:0,"
    "psf-accumulated=cache:psf,history:accumulate,apsf=cache:apsf,history:none,apg=cache:apg,history:none,"
    "apg.feed:1,apg+apsf=cache:apsf+apg,history:none,apg.feed:1";

/// The contenders of kCacheOptions, in the same syntax, each after a comma.
std::string option_contenders_text() {
  std::string text;
  for (const CacheOption& option : kCacheOptions)
    text += fmt::format(",{}={},history:none", option.name, option.settings);
  return text;
}

/// MSE per repetition after `frames` frames, without the reference's noise. The curves must have a point there.
std::vector<double> errors_at(const Comparison& c, std::string_view name, uint32_t frames) {
  std::vector<double> errors;
  for (const Repetition& r : contender_named(c, name).repetitions) {
    const auto point =
        std::find_if(r.curve.begin(), r.curve.end(), [&](const ErrorPoint& p) { return p.frames == frames; });
    errors.push_back(point->mse - c.reference.mse);
  }
  return errors;
}

Ratio ratio_at(const Comparison& c, std::string_view a, std::string_view b, uint32_t frames) {
  return paired_error_ratio(errors_at(c, a, frames), errors_at(c, b, frames));
}

/// Frame counts up to eight with points on the curves.
constexpr uint32_t kFirstFrames[] = {1, 2, 3, 4, 6, 8};

/// Ratios of a's MSE over b's in the first frames.
std::vector<Ratio> first_ratios(const Comparison& c, std::string_view a, std::string_view b) {
  std::vector<Ratio> list;
  for (const uint32_t frames : kFirstFrames) list.push_back(ratio_at(c, a, b, frames));
  return list;
}

const Ratio& largest(const std::vector<Ratio>& list) {
  return *std::max_element(list.begin(), list.end(), [](const Ratio& a, const Ratio& b) { return a.value < b.value; });
}

std::string first_frame_text(const std::string& scene) {
  return scene + ": at one sample per pixel and without a history, psf at least halves the MSE of path tracing.";
}
std::string filter_text(const std::string& scene) {
  return scene +
         ": away from lamps, where it traces no additional camera rays, psf at least halves the MSE of path tracing, "
         "too.";
}
std::string accumulation_text(const std::string& scene) {
  return scene +
         ": with a history, psf stays below plain accumulation for at least eight frames (after 1, 2, 3, 4, 6 and "
         "8).";
}
std::string apsf_text(const std::string& scene) {
  return scene + ": adaptive path space filtering has roughly the MSE of psf.";
}
std::string apg_text(const std::string& scene) {
  return scene + ": adaptive path graphs have roughly the MSE of psf, too.";
}
std::string option_text(const CacheOption& option, const std::string& scene) {
  return fmt::format("{}: {} has no more MSE than {}, in the first frame and after 16.", scene, option.name,
                     option.basis);
}
std::string option_id(const CacheOption& option, const std::string& scene) {
  return fmt::format("option-{}-{}", option.name, scene);
}
constexpr const char* kNoMore = "at most 1.02 in both";
constexpr const char* kHalf = "at most 0.5";
constexpr const char* kBelow = "at most 1 in each frame";
constexpr const char* kSimilar = "at most 1.1";
constexpr const char* kRoughlySimilar = "at most 2";

void claim_first_frame(const Comparison& c, std::vector<Claim>& claims) {
  const Ratio ratio = ratio_at(c, "psf", "path", 1);
  claims.push_back(judged_within("first-frame-" + c.options.scene_name, kOurs, first_frame_text(c.options.scene_name),
                                 share_text(ratio) + " of path tracing's", kHalf, {ratio}, 0, 0.5));
}

/// MSE of the first frames, over all pixels and away from lamps.
struct FirstFrames {
  std::vector<double> all;
  std::vector<double> away;
};

FirstFrames first_frames(const ExperimentContext& context, const ExperimentScene& scene, const RenderSettings& settings,
                         const Reference& reference, const PixelMask& surfaces) {
  const PixelMask all = mask_of({"image"}, reference.image.width, reference.image.height);
  Session session(scene.scene, settings);
  session.set_camera(scene.camera);
  const auto measure = [&](const ExperimentContext& own, int seed) {
    own.check_stop();
    session.restart(1 + seed);
    session.render_frame();
    const Image image = session.image();
    return std::array{frame_mse(image, reference.image, all) - reference_noise(reference, all),
                      frame_mse(image, reference.image, surfaces) - reference_noise(reference, surfaces)};
  };
  FirstFrames errors;
  for (const auto& [whole, away] :
       deal_parts(context, "first frames of " + scene.name, context.choose(16, 4), measure)) {
    errors.all.push_back(whole);
    errors.away.push_back(away);
  }
  return errors;
}

/// Separates the gain of the filter from that of the camera rays at lamp edges.
void claim_filter_alone(const ExperimentContext& context, const ExperimentScene& scene, std::vector<Claim>& claims) {
  const Reference reference = make_reference(context, plainly_sampled(scene));
  const PixelMask surfaces = surfaces_of(context, scene);
  const std::vector<NamedSettings> contenders = cache_contenders(context, scene);
  RenderSettings settings = contenders[1].settings;
  const FirstFrames path = first_frames(context, scene, contenders[0].settings, reference, surfaces);
  const FirstFrames psf = first_frames(context, scene, settings, reference, surfaces);
  settings.psf.edge_rays = 0;
  const FirstFrames plain = first_frames(context, scene, settings, reference, surfaces);
  const Ratio away = paired_error_ratio(psf.away, path.away);
  claims.push_back(judged_within(
      "first-frame-filter-" + scene.name, kOurs, filter_text(scene.name),
      fmt::format("{} of path tracing's MSE without the pixels at lamps ({} with psf.edge-rays 0); of whole images {}, "
                  "and {} with psf.edge-rays 0",
                  share_text(away), share_text(paired_error_ratio(plain.away, path.away)),
                  share_text(paired_error_ratio(psf.all, path.all)),
                  share_text(paired_error_ratio(plain.all, path.all))),
      kHalf, {away}, 0, 0.5));
}

void claim_accumulation(const Comparison& c, std::vector<Claim>& claims) {
  const std::vector<Ratio> cells = first_ratios(c, "psf", "accumulated");
  const std::vector<Ratio> both = first_ratios(c, "psf-accumulated", "accumulated");
  claims.push_back(
      judged_within("first-frames-" + c.options.scene_name, kOurs, accumulation_text(c.options.scene_name),
                    fmt::format("at most {} of accumulation's MSE ({} without a history except the cells')",
                                share_text(largest(both)), share_text(largest(cells))),
                    kBelow, both, 0, 1));
}

void claim_similar(const Comparison& c, std::vector<Claim>& claims) {
  const std::string& scene = c.options.scene_name;
  const auto claim = [&](const char* cache, std::string text, const char* threshold, double most) {
    const Ratio late = ratio_at(c, cache, "psf", 16);
    claims.push_back(judged_within(fmt::format("{}-{}", cache, scene), kPaper, std::move(text),
                                   fmt::format("after 16 frames {} of psf's; in the first {}", share_text(late),
                                               share_text(ratio_at(c, cache, "psf", 1))),
                                   threshold, {late}, 0, most));
  };
  claim("apsf", apsf_text(scene), kSimilar, 1.1);
  claim("apg", apg_text(scene), kRoughlySimilar, 2);
}

/// In the mine, most cells of the first frame have few samples.
void claim_mine(const Comparison& c, std::vector<Claim>& claims) {
  const Ratio neighbours = ratio_at(c, "psf", "path", 1);
  const Ratio both = ratio_at(c, "psf-neighbours-coarser", "path", 1);
  claims.push_back(judged_within(
      "option-first-frame-mine", kOurs,
      "mine: cells pooled with neighbours and a coarser cell quarter the MSE of path tracing in the first frame.",
      fmt::format("{} of path tracing's; with neighbours alone {}", share_text(both), share_text(neighbours)),
      "at most 0.25", {both}, 0, 0.25));
}

void claim_options(const Comparison& c, std::vector<Claim>& claims) {
  const std::string& scene = c.options.scene_name;
  for (const CacheOption& option : kCacheOptions) {
    const Ratio first = ratio_at(c, option.name, option.basis, 1);
    const Ratio late = ratio_at(c, option.name, option.basis, 16);
    claims.push_back(judged_within(
        option_id(option, scene), kOurs, option_text(option, scene),
        fmt::format("in the first frame {} of {}'s, after 16 frames {}; {} and {} of path tracing's", share_text(first),
                    option.basis, share_text(late), share_text(ratio_at(c, option.name, "path", 1)),
                    share_text(ratio_at(c, option.name, "path", 16))),
        kNoMore, {first, late}, 0, 1.02));
  }
  if (scene == "mine") claim_mine(c, claims);
}

std::vector<SponzaClaim> option_claims_about_sponza() {
  std::vector<SponzaClaim> list;
  for (const CacheOption& option : kCacheOptions)
    list.push_back({option_id(option, "Sponza"), option_text(option, "Sponza"), kNoMore});
  return list;
}

/// MSE per repetition, averaged over the frames, without the reference's noise.
std::vector<double> errors_of(const Comparison& c, std::string_view name) {
  return values_of(contender_named(c, name), [&](const Repetition& r) { return r.mse - c.reference_noise.mse; });
}

/// Figure 6.4: measures frames along a scene's camera path.
void measure_walk(const ExperimentContext& context, const char* name, int bounces, ExperimentResult& result) {
  const Comparison c = study(context, built_in(name, bounces),
                             {.techniques = kContenders,
                              .spp = 1,
                              .times_s = frame_times(context.choose(12, 3)),
                              .repetitions = 3,
                              .reference_spp = context.choose(512, 16)});
  const auto ratio = [&](std::string_view cache) {
    return paired_error_ratio(errors_of(c, cache), errors_of(c, "path"));
  };
  const Ratio psf = ratio("psf");
  const Ratio apsf = ratio("apsf");
  result.claims.push_back(
      judged_within(fmt::format("walk-{}", name), kPaper,
                    fmt::format("{}, moving camera: filtered frames have less error than those of path tracing.", name),
                    fmt::format("psf {}, apsf {} of path tracing's", share_text(psf), share_text(apsf)),
                    "both at most 1", {psf, apsf}, 0, 1));
  const std::vector<Block> blocks = study_blocks(fmt::format("{}, moving camera", name), c);
  result.blocks.insert(result.blocks.end(), blocks.begin(), blocks.end());
}

ExperimentResult run_psf_error(const ExperimentContext& context) {
  ExperimentResult result;
  const int repetitions = context.choose(8, 3);
  for (const ExperimentScene& scene : cache_scenes(context)) {
    const bool options = measures_options(context, scene);
    const Comparison c = study(context, scene,
                               {.techniques = kContenders + (options ? option_contenders_text() : std::string()),
                                .reference = {{"lights", "light-tree"}},
                                .spp = context.choose(24, 16),
                                .repetitions = repetitions});
    claim_first_frame(c, result.claims);
    claim_filter_alone(context, scene, result.claims);
    claim_accumulation(c, result.claims);
    claim_similar(c, result.claims);
    if (options) claim_options(c, result.claims);
    const std::vector<Block> blocks = study_blocks(scene.name, c);
    result.blocks.insert(result.blocks.end(), blocks.begin(), blocks.end());
  }
  claim_without_sponza(context, kOurs,
                       {{"first-frame-Sponza", first_frame_text("Sponza"), kHalf},
                        {"first-frame-filter-Sponza", filter_text("Sponza"), kHalf},
                        {"first-frames-Sponza", accumulation_text("Sponza"), kBelow}},
                       result.claims);
  claim_without_sponza(
      context, kPaper,
      {{"apsf-Sponza", apsf_text("Sponza"), kSimilar}, {"apg-Sponza", apg_text("Sponza"), kRoughlySimilar}},
      result.claims);
  claim_without_sponza(context, kOurs, option_claims_about_sponza(), result.claims);
  measure_walk(context, "corridor", 10, result);
  result.setup = {common_setup(context).front(),
                  {"Samples", "1 per pixel and frame"},
                  {"Bounces", "6; corridor: 10"},
                  {"Settings", "the defaults of each technique; apg.feed 1, as in the thesis"},
                  {"Light selection", "by power; in references by the light tree"},
                  {"Repetitions", fmt::format("{}; of the walk, 3", repetitions)}};
  return result;
}

}  // namespace

Experiment psf_error_experiment() {
  return {"psf-error", kPaper, "error of path space filtering at one sample per pixel", run_psf_error};
}

}  // namespace relume
