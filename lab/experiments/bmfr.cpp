// [Sun20 §5.1.3]: measures how well caustics, colour bleeding, shadows and mirror images survive denoising, and how far
// denoising reduces the error of still and moving images.
#include <algorithm>
#include <functional>
#include <map>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>

#include "compare/comparison_page.h"
#include "compare/timed_session.h"
#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/regions.h"
#include "experiments/setup/named.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"
#include "render/session.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Sun20 §5.1.3]";
constexpr const char* kOurs = "[relume]";
constexpr const char* kDenoisers[] = {"bmfr", "svgf"};
/// Denoisers trace additional camera rays at lamp edges, which would favour them at equal samples. Claims concern the
/// filters alone and disable these rays; images show both variants.
constexpr const char* kOfSamples =
    "none=denoise:none,bmfr=denoise:bmfr,features.edge-rays:0,svgf=denoise:svgf,features.edge-rays:0,"
    "koskela=history:none,denoise:bmfr,features.edge-rays:0,bmfr.alpha:0.2,bmfr.detail:0";
/// Settings of [Koskela19]: frames weigh at least a fifth in the first accumulation. The image is the fit, without
/// details and without the mean of samples. Shown for comparison; not used in claims.
constexpr const char* kOfPaper = "koskela";
constexpr const char* kBeside[] = {kDenoisers[0], kDenoisers[1], kOfPaper};
constexpr int kSide = 160;  ///< size of still images

/// A feature named by the paper and its region in a still image.
struct Feature {
  const char* scene;
  Rectangle region;
};

const Feature kFeatures[] = {
    {"cornell-spheres", {"caustic", 0.55, 0.82, 0.95, 0.97}},
    {"cornell-spheres", {"colour bleeding", 0.22, 0.06, 0.38, 0.2}},
    {"cornell-spheres", {"shadow", 0.1, 0.8, 0.5, 0.95}},
    {"cornell-mirror", {"mirror image", 0.22, 0.22, 0.78, 0.6}},
    {"cornell-water", {"caustic", 0.2, 0.2, 0.8, 0.6}},
};

struct Still {
  std::string name;  ///< scene
  std::vector<Rectangle> regions;
  Comparison comparison;
  Image clean;  ///< independent_image()
};

/// Second converged image, without a denoiser. Noise in the reference adds contrast and detail that no image can keep.
/// The result is therefore relative to the share kept by this image.
Image independent_image(const ExperimentContext& context, const ExperimentScene& scene, EstimatorChoice estimator,
                        const Image& reference) {
  RenderSettings settings = scene.settings;
  settings.width = reference.width;
  settings.height = reference.height;
  settings.estimator = estimator;
  settings.seed = 77;
  settings.device = context.device;
  return measure_on_first(context, scene.name + ", without a denoiser", [&](const ExperimentContext& own) {
    Session session(scene.scene, settings);
    session.set_camera(scene.camera);
    for (int i = 0; i < own.choose(256, 16); ++i) {
      own.check_stop();
      session.render_frame();
    }
    return session.image();
  });
}

Still measure_still(const ExperimentContext& context, const std::string& name) {
  StudyOptions options{.techniques = std::string(kOfSamples) + ",bmfr-edges=denoise:bmfr,svgf-edges=denoise:svgf",
                       .spp = 8,
                       .repetitions = 6,
                       .reference_spp = 512};
  use_square(context, kSide, options);
  options.common.emplace_back("estimator", "bdpt");
  options.reference = {{"estimator", "bdpt"}};
  std::vector<Rectangle> regions;
  for (const Feature& f : kFeatures) {
    if (f.scene == name) regions.push_back(f.region);
  }
  const ExperimentScene scene = built_in(name, 8);
  Comparison comparison = study(context, scene, options);
  Image clean = independent_image(context, scene, EstimatorChoice::bdpt, comparison.reference.image);
  return {name, std::move(regions), std::move(comparison), std::move(clean)};
}

/// Sponza with a camera that rests and then walks and turns. `still` and `moving` are numbers of frames at 24 per
/// second.
ExperimentScene sponza_walk(ExperimentScene hall, int still, int moving) {
  Scene& scene = hall.scene;
  for (Node& node : scene.nodes) node.camera = kNone;
  scene.cameras = {hall.camera->camera};
  Node node;
  node.name = "walk";
  node.camera = 0;
  node.transform.rotation = glm::quat_cast(Mat3(hall.camera->to_world));
  node.transform.translation = Vec3(hall.camera->to_world[3]);
  AnimationChannel place;
  place.node = scene.add_node(std::move(node));
  AnimationChannel turn = place;
  turn.property = AnimatedProperty::rotation;
  for (int i = still - 1; i < still + moving; ++i) {
    const auto step = static_cast<float>(i - still + 1);
    const Mat4 pose = turned_ahead(hall, kWalkTurn_deg * step, kWalkStep_m * step)->to_world;
    const glm::quat q = glm::quat_cast(Mat3(pose));
    place.times.push_back(static_cast<float>(i) / 24);
    place.values.emplace_back(Vec3(pose[3]), 0);
    turn.times.push_back(static_cast<float>(i) / 24);
    turn.values.emplace_back(q.x, q.y, q.z, q.w);
  }
  scene.animation = {place, turn};
  hall.camera.reset();
  return hall;
}

struct Walk {
  int still = 0;
  Comparison comparison;

  /// MSE of the noisy input over the denoiser's, for each frame in [begin, end).
  std::vector<Ratio> ratios(std::string_view name, int begin, int end) const {
    std::vector<Ratio> list;
    for (int i = begin; i < end; ++i) list.push_back(error_ratio(at("noisy", i), at(name, i)));
    return list;
  }
  int frames() const { return static_cast<int>(comparison.options.times_s.size()); }

 private:
  /// MSE per repetition, minus the noise of the last frame's reference, which is used for all frames.
  std::vector<double> at(std::string_view name, int frame) const {
    return values_of(contender_named(comparison, name), [&](const Repetition& r) {
      return r.curve[static_cast<size_t>(frame)].mse - comparison.reference.mse;
    });
  }
};

Walk measure_walk(const ExperimentContext& context, const ExperimentScene& hall) {
  const int still = 4;
  const int moving = context.choose(8, 3);
  StudyOptions options{.techniques = std::string("noisy=history:none,") + kOfSamples,
                       .times_s = frame_times(still + moving),
                       .repetitions = 4,
                       .reference_spp = 64};
  if (!context.quick) options.common = {{"width", "480"}, {"height", "270"}};
  return {still, study(context, sponza_walk(hall, still, moving), options)};
}

/// Claim about milliseconds of each frame, on the processor.
Claim claim_time(const ExperimentContext& context, const std::vector<double>& fit, const std::vector<double>& features,
                 const std::vector<double>& all) {
  const char* const claim = "Denoising is fast enough for interactive images.";
  const char* const threshold = "at most 40 ms and 100 ms on two cores, by the interval";
  if (!context.measures_host()) return unmeasured("time", kOurs, claim, threshold, "needs --device cpu");
  if (context.threads == 1) return unmeasured("time", kOurs, claim, threshold, "needs two threads");
  const Interval of_fit = median_interval(fit);
  const Interval of_all = median_interval(all);
  return with_verdict(
      "time", kOurs, claim,
      fmt::format("regression {:.0f} ms ({:.0f} to {:.0f}), all of bmfr {:.0f} ms ({:.0f} to {:.0f}), {:.0f} of them "
                  "for features",
                  median(fit), of_fit.low, of_fit.high, median(all), of_all.low, of_all.high, median(features)),
      threshold, verdict_of_all({verdict_of(of_fit, 0, 40), verdict_of(of_all, 0, 100)}));
}

/// Milliseconds of each pass, by frame after the first.
std::map<std::string, std::vector<double>> pass_times(const ExperimentContext& context, const ExperimentScene& scene,
                                                      int frames) {
  const auto list = measure_on_first(context, scene.name + ", times", [&](const ExperimentContext& own) {
    TimedSession session(scene.scene, scene.settings);
    session.session().on_pass([](const std::string&) {});
    std::map<std::string, std::vector<double>> times;
    for (int i = 0; i <= frames; ++i) {
      own.check_stop();
      const std::vector<PassTime> before = session.passes();
      session.render_frame();
      if (i == 0) continue;
      for (const PassTime& pass : pass_times_since(session.passes(), before))
        times[pass.name].push_back(1000 * pass.seconds);
    }
    return std::vector<std::pair<std::string, std::vector<double>>>(times.begin(), times.end());
  });
  return {list.begin(), list.end()};
}

/// Measures denoising time per frame at 1280 × 720 (160 × 90 in a quick run) by pass, including features and lamp
/// edges. Every pixel shows a surface. A hook makes the features pass evaluate the surfaces. Without a hook, path
/// tracing provides them, and the time of the features would count as tracing.
BarBlock measure_times(const ExperimentContext& context, std::vector<Claim>& claims) {
  const int width = context.choose(1280, 160);
  const int height = context.choose(720, 90);
  BarBlock block{fmt::format("Frame time at {} × {}", width, height),
                 fmt::format("cornell-closed, one bounce, {}; after the first frame, without tracing.",
                             context.measures_host() ? "at most two threads" : "on the GPU"),
                 "ms",
                 {}};
  const int frames = context.choose(24, 3);
  for (const char* name : kDenoisers) {
    ExperimentScene scene = built_in("cornell-closed", 1);
    scene.settings.width = width;
    scene.settings.height = height;
    scene.settings.threads = 2;
    scene.settings.device = context.device;
    scene.settings.denoise = name == kDenoisers[0] ? DenoiseChoice::bmfr : DenoiseChoice::svgf;
    std::map<std::string, std::vector<double>> times = pass_times(context, scene, frames);
    Bar bar{name, {}};
    std::vector<double> sums(static_cast<size_t>(frames), 0.0);  // per frame
    for (auto& [pass, values] : times) {
      if (!pass.starts_with(name) && pass != "features" && pass != "edges") continue;
      bar.parts.emplace_back(pass, median(values));
      for (size_t i = 0; i < sums.size(); ++i) sums[i] += values[i];
    }
    block.bars.push_back(std::move(bar));
    if (name == kDenoisers[0]) claims.push_back(claim_time(context, times["bmfr-fit"], times["features"], sums));
  }
  return block;
}

/// Applies `value` to the image of each repetition.
std::vector<double> of_images(const Comparison& c, std::string_view name,
                              const std::function<double(const Image&)>& value) {
  std::vector<double> values;
  for (const Image& image : contender_named(c, name).images) values.push_back(value(image));
  return values;
}

/// Text "91 % (90 to 92)" of shares.
std::string percent_text(const std::vector<double>& shares) {
  const Interval interval = mean_interval(shares);
  return fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100 * mean(shares), 100 * interval.low, 100 * interval.high);
}

/// Each kind of feature keeps its contrast, with a lower error than the same samples without a denoiser.
void claim_features(const std::vector<Still>& stills, std::vector<Claim>& claims) {
  for (const Feature& f : kFeatures) {
    const Still& still = named(stills, "scene", f.scene);
    const Comparison& c = still.comparison;
    const double possible = contrast_kept(still.clean, c.reference.image, f.region);
    std::string measured;
    const char* verdict = kVerdictUndecided;
    for (const char* name : kBeside) {
      const std::vector<double> kept = of_images(
          c, name, [&](const Image& image) { return contrast_kept(image, c.reference.image, f.region) / possible; });
      const Ratio error = region_ratio(c, name, "none", f.region);
      if (name == kDenoisers[0])
        verdict = verdict_of_all({verdict_of(mean_interval(kept), 0.9), verdict_of(error.interval, 0, 1)});
      measured += fmt::format("{}{}: {} of the contrast, {} of the MSE", measured.empty() ? "" : "; ", name,
                              percent_text(kept), share_text(error));
    }
    std::string id = fmt::format("{}-{}", std::string_view(f.scene).substr(8), f.region.name);
    std::replace(id.begin(), id.end(), ' ', '-');
    claims.push_back(with_verdict(std::move(id), kPaper, fmt::format("{}: the {} is kept.", f.scene, f.region.name),
                                  measured,
                                  "bmfr keeps 90 % of the contrast (relume's bound), with a lower MSE than the mean of "
                                  "its samples, by the interval",
                                  verdict));
  }
}

Claim claim_error(const std::vector<Still>& stills) {
  const Rectangle all{"image"};
  std::string measured;
  std::vector<Ratio> of_bmfr;
  for (const Still& s : stills) {
    const auto share = [&](const char* name) { return region_ratio(s.comparison, name, "none", all); };
    of_bmfr.push_back(share("bmfr"));
    measured +=
        fmt::format("{}{}: {}; svgf {}; {} {}; with camera rays at edges of lamps {:.2f} and {:.2f}",
                    measured.empty() ? "" : "; ", s.name, share_text(of_bmfr.back()), share_text(share("svgf")),
                    kOfPaper, share_text(share(kOfPaper)), share("bmfr-edges").value, share("svgf-edges").value);
  }
  return judged_within("error", kPaper, "Denoised images have less error than the mean of the same samples.",
                       measured + " of its MSE after 8 samples", "below 1 in every scene", of_bmfr, 0, 1);
}

/// Cloth and stone in Sponza.
const Rectangle kTextures[] = {
    {"left curtain", 0.0, 0.38, 0.17, 0.96}, {"right curtain", 0.82, 0.4, 1.0, 0.96}, {"floor", 0.35, 0.7, 0.65, 0.98}};
constexpr const char* kTextureClaim = "Textures stay sharp: they have the detail of the reference.";

/// Eight frames of one sample per pixel with a static camera.
Comparison claim_textures(const ExperimentContext& context, const ExperimentScene& hall, std::vector<Claim>& claims) {
  StudyOptions options{.techniques = kOfSamples, .spp = 8, .repetitions = 4, .reference_spp = 1024};
  if (!context.quick) options.common = {{"width", "480"}, {"height", "270"}};
  Comparison c = study(context, hall, options);
  const Image clean = independent_image(context, hall, EstimatorChoice::path, c.reference.image);
  std::vector<const char*> verdicts;
  std::string measured;
  for (const char* name : kBeside) {
    for (const Rectangle& region : kTextures) {
      const double possible = detail_kept(clean, c.reference.image, region);
      const std::vector<double> kept = of_images(
          c, name, [&](const Image& image) { return detail_kept(image, c.reference.image, region) / possible; });
      if (name != kOfPaper) verdicts.push_back(verdict_of(mean_interval(kept), 0.95));
      measured += fmt::format("{}{}, {}: {}", measured.empty() ? "" : "; ", name, region.name, percent_text(kept));
    }
  }
  claims.push_back(
      with_verdict("textures", kOurs, kTextureClaim, measured + " after 8 samples",
                   "at least 95 % of the reference's differences between neighbouring pixels, by the interval",
                   verdict_of_all(verdicts)));
  return c;
}

void claim_walk(const Walk* walk, std::vector<Claim>& claims) {
  const std::string still =
      "At one sample per frame, the MSE of the denoised image is a tenth of the noisy image's while nothing moves.";
  const std::string moving =
      "At one sample per frame, the MSE of the denoised image is a fifth of the noisy image's while the camera walks.";
  if (!walk) {
    claims.push_back(unmeasured("walk-still", kOurs, still, "10 ×", kNoSponza));
    claims.push_back(unmeasured("walk-moving", kOurs, moving, "5 ×", kNoSponza));
    return;
  }
  const auto judge = [&](const char* id, const std::string& text, int begin, int end, double factor) {
    std::vector<Ratio> all;
    std::string measured;
    for (const char* name : kBeside) {
      const std::vector<Ratio> ratios = walk->ratios(name, begin, end);
      const Ratio& least = *std::min_element(ratios.begin(), ratios.end(),
                                             [](const Ratio& a, const Ratio& b) { return a.value < b.value; });
      measured += fmt::format("{}{}: at least {}", measured.empty() ? "" : ", ", name, to_text(least));
      if (name != kOfPaper) all.insert(all.end(), ratios.begin(), ratios.end());
    }
    claims.push_back(judged_ratios(id, kOurs, text, measured + " in every frame", all, factor));
  };
  judge("walk-still", still, 0, walk->still, 10);
  judge("walk-moving", moving, walk->still, walk->frames(), 5);
}

ExperimentResult run_bmfr(const ExperimentContext& context) {
  std::vector<Still> stills;
  for (const char* scene : {"cornell-spheres", "cornell-mirror", "cornell-water"})
    stills.push_back(measure_still(context, scene));
  const std::optional<ExperimentScene> hall = sponza(context);
  std::optional<Walk> walk;
  ExperimentResult result;
  if (hall) {
    walk = measure_walk(context, *hall);
    const Comparison textures = claim_textures(context, *hall, result.claims);
    result.blocks.emplace_back(
        region_images("Sponza, textures", textures, {std::begin(kTextures), std::end(kTextures)}));
  } else {
    result.claims.push_back(unmeasured("textures", kOurs, kTextureClaim, "95 %", kNoSponza));
  }
  claim_features(stills, result.claims);
  result.claims.push_back(claim_error(stills));
  claim_walk(walk ? &*walk : nullptr, result.claims);
  BarBlock times = measure_times(context, result.claims);
  for (const Still& s : stills) {
    result.blocks.emplace_back(region_images(s.name, s.comparison, s.regions));
    result.blocks.emplace_back(comparison_table(s.comparison));
  }
  if (walk) {
    for (Block& block : study_blocks("Sponza", walk->comparison)) result.blocks.push_back(std::move(block));
  }
  result.blocks.emplace_back(std::move(times));
  result.setup = {
      {kOfPaper,
       "BMFR as in [Koskela19]: bmfr.alpha 0.2, no details, and no mean of the samples; no verdict depends on it"},
      {"Boxes", square_text(context, kSide) + ", 8 samples of bdpt"},
      {"Sponza",
       "one sample per frame of path tracing; the camera stands, then walks 5 cm and turns 0.5° per frame; the noise "
       "of the reference (64 samples) is known and subtracted from every MSE"},
      {"Contrast",
       "slope of image against reference luminance, both clamped at 1, divided by the slope of another image with many "
       "samples"}};
  return result;
}

}  // namespace

Experiment bmfr_experiment() { return {"bmfr", kPaper, "detail and error of denoised images", run_bmfr}; }

}  // namespace relume
