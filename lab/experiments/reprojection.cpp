// [Schalk18 §4.3]: turns the camera by 100 degrees in steps, and measures the error after the last step and the
// overhead per frame.
#include <algorithm>
#include <cmath>
#include <memory>
#include <tuple>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schalk18 §4.3]";
constexpr const char* kOurs = "[relume]";
constexpr const char* kBelowOne = "every ratio at most 1";
constexpr float kSmallestError = 1.0f / 256;
constexpr float kEyeStep_m = 0.01f;  ///< motion of the eye per frame or per step of five degrees

struct Case {
  float step_deg;
  std::vector<Trace> traces;  ///< restarted accumulation first
  ImageSet images = {};
};

struct SceneResult {
  std::string name;
  std::string property;
  std::vector<Case> cases;  ///< smallest step first
};

struct Overhead {
  std::string scene;
  bool moving = false;  ///< the eye also moves, so that eq. 15 is evaluated
  double anew_ms = 0;
  double one_ms = 0;   ///< with one stored sample
  double four_ms = 0;  ///< with four stored samples
  Ratio one;           ///< frame time with one over that of restarted accumulation
  Ratio four;
  double one_bytes = 0;   ///< per pixel, in addition to restarted accumulation
  double four_bytes = 0;  ///< same, with four
};
constexpr auto members_of(const Overhead*) {
  return std::tuple(&Overhead::scene, &Overhead::moving, &Overhead::anew_ms, &Overhead::one_ms, &Overhead::four_ms,
                    &Overhead::one, &Overhead::four, &Overhead::one_bytes, &Overhead::four_bytes);
}

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, int samples_per_step,
                         StoredSampleChoice stored, float error) {
  TraceContender result{
      .name = samples_per_step == 0 ? "restart" : "", .settings = scene.settings, .samples_per_step = samples_per_step};
  set_size_and_device(context, result.settings);
  if (samples_per_step == 0) return result;
  result.settings.history = HistoryChoice::reproject;
  result.settings.reproject.stored = stored;
  result.settings.reproject.fill = false;  // not part of the paper
  result.settings.reproject.error = error;
  result.name = fmt::format("{} stored, {} per step", stored == StoredSampleChoice::four ? 4 : 1, samples_per_step);
  if (error != kSmallestError) result.name += fmt::format(", ε {}/256", std::lround(error * 256));
  return result;
}

/// Contenders of one chart of the paper. For variations of the scene, one stored sample suffices.
std::vector<TraceContender> contenders(const ExperimentContext& context, const ExperimentScene& scene, bool all) {
  using enum StoredSampleChoice;
  const int few = context.quick ? 8 : 32;
  std::vector<TraceContender> list{contender(context, scene, 0, one, 0),
                                   contender(context, scene, few, one, kSmallestError)};
  if (!scene.property.empty()) return list;
  list.push_back(contender(context, scene, few, four, kSmallestError));
  if (!all || context.quick) return list;
  list.push_back(contender(context, scene, 2 * few, one, kSmallestError));
  list.push_back(contender(context, scene, 2 * few, four, kSmallestError));
  return list;
}

/// `aside_m` is the eye's motion during the turn.
Case measure(const ExperimentContext& context, const ExperimentScene& scene, const Reference& reference, float step_deg,
             const std::vector<TraceContender>& list, float aside_m = 0) {
  const TraceOptions options{.turn = {100, step_deg, aside_m},
                             .frames = context.quick ? 16u : 64u,
                             .repetitions = context.choose(3, 1),
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .image_frame = 4};
  const std::string name = fmt::format("{}, {:.0f}°", scene.name, step_deg);
  std::vector<Trace> traces = trace(context, name, scene, list, options);
  ImageSet images = trace_images(name, traces, reference.image);
  return {step_deg, std::move(traces), std::move(images)};
}

SceneResult measure_scene(const ExperimentContext& context, const ExperimentScene& scene, std::vector<float> steps,
                          bool all) {
  const Reference reference = make_reference(context, scene);
  SceneResult result{scene.name, scene.property, {}};
  for (float step : steps) {
    const bool smallest = step == steps.front();  // used by most claims
    result.cases.push_back(measure(context, scene, reference, step, contenders(context, scene, all && smallest)));
  }
  return result;
}

/// MSE ratio to the baseline (by default restarted accumulation) at equal time, from the end of the first frame to the
/// eighth.
Ratio early_ratio(const Case& c, size_t i, size_t baseline = 0) { return early_ratio(c.traces, i, baseline, 8); }

/// Offset of a moving eye, back and forth within the room.
float aside_at(int frame) {
  constexpr int kThereAndBack = 40;
  return kEyeStep_m * static_cast<float>(std::abs((frame + kThereAndBack / 2) % kThereAndBack - kThereAndBack / 2));
}

Overhead measure_overhead_alone(const ExperimentContext& context, const ExperimentScene& scene, bool moving) {
  const int frames = context.quick ? 40 : 250;
  using enum StoredSampleChoice;
  std::vector<std::unique_ptr<TimedSession>> sessions;
  const TraceContender list[] = {contender(context, scene, 0, one, 0),
                                 contender(context, scene, 1, one, kSmallestError),
                                 contender(context, scene, 1, four, kSmallestError)};
  for (const TraceContender& c : list) sessions.push_back(std::make_unique<TimedSession>(scene.scene, c.settings));
  for (int frame = 0; frame < frames; ++frame) {
    context.check_stop();
    for (auto& session : sessions) {
      session->session().set_camera(
          turned_aside(scene, -0.4f * static_cast<float>(frame), moving ? aside_at(frame) : 0.0f));
      session->render_frame();
    }
    context.report(scene.name + (moving ? ", overhead of a moving camera" : ", overhead"), (frame + 1.0) / frames);
  }
  const auto usual_s = [](const TimedSession& session) {
    return std::vector<double>(session.frame_s().begin() + 4, session.frame_s().end());
  };
  const std::vector<double> anew_s = usual_s(*sessions[0]);
  const std::vector<double> one_s = usual_s(*sessions[1]);
  const std::vector<double> four_s = usual_s(*sessions[2]);
  const auto pixel_bytes = [](const TimedSession& session) {
    const Statistics& s = session.session().statistics();
    const RenderSettings& settings = render_settings(session.session());
    return static_cast<double>(s.buffer_bytes + s.technique_bytes) / (double{1} * settings.width * settings.height);
  };
  const double anew_bytes = pixel_bytes(*sessions[0]);
  return {scene.name + (moving ? ", moving" : ""),
          moving,
          1000 * median(anew_s),
          1000 * median(one_s),
          1000 * median(four_s),
          time_ratio(one_s, anew_s),
          time_ratio(four_s, anew_s),
          pixel_bytes(*sessions[1]) - anew_bytes,
          pixel_bytes(*sessions[2]) - anew_bytes};
}

/// The same on the first rank.
Overhead measure_overhead(const ExperimentContext& context, const ExperimentScene& scene, bool moving) {
  return measure_on_first(context, scene.name + ", overhead",
                          [&](const ExperimentContext& own) { return measure_overhead_alone(own, scene, moving); });
}

TableBlock overhead_table(const std::vector<Overhead>& list) {
  TableBlock block{
      "Overhead",
      "Median time of a frame of one sample while the camera turns by 0.4° per frame; \"moving\": it also moves by 1 "
      "cm, without which eq. 15 is zero and not evaluated. The share is that of the new frame, as in the paper. Memory "
      "is the addition per pixel; the paper's is 144 bytes with one stored sample (133 MB).",
      "scene",
      {{"restart, ms"}, {"1 stored, ms"}, {"share"}, {"bytes"}, {"4 stored, ms"}, {"share"}, {"bytes"}},
      {}};
  const auto share = [](const Ratio& frame) {
    const double value = 1 - 1 / frame.value;
    return TableCell{fmt::format("{:.0f} %", 100 * value), value};
  };
  for (const Overhead& o : list) {
    block.rows.push_back({o.scene,
                          kNeutralColor,
                          {{fmt::format("{:.2f}", o.anew_ms), o.anew_ms},
                           {fmt::format("{:.2f}", o.one_ms), o.one_ms},
                           share(o.one),
                           {fmt::format("{:.0f}", o.one_bytes), o.one_bytes},
                           {fmt::format("{:.2f}", o.four_ms), o.four_ms},
                           share(o.four),
                           {fmt::format("{:.0f}", o.four_bytes), o.four_bytes}}});
  }
  return block;
}

/// Share of the overhead in the frame, with its interval, in percent.
std::string overhead_text(const Ratio& frame) {
  const auto percent = [](double ratio) { return 100 * (1 - 1 / ratio); };
  return fmt::format("{:.0f} % ({:.0f} to {:.0f})", percent(frame.value), percent(frame.interval.low),
                     percent(frame.interval.high));
}

void claim_overhead(const std::vector<Overhead>& list, bool moving, std::vector<Claim>& claims) {
  constexpr double kMostShare = 0.26;
  std::string measured;
  std::vector<Ratio> ratios;
  for (const Overhead& o : list) {
    if (o.moving != moving) continue;
    ratios.insert(ratios.end(), {o.one, o.four});
    measured += fmt::format("{}{}: {} and {}", measured.empty() ? "" : "; ", o.scene, overhead_text(o.one),
                            overhead_text(o.four));
  }
  claims.push_back(judged_within(
      moving ? "overhead-moving" : "overhead", moving ? kOurs : kPaper,
      fmt::format("Reprojection takes 15 to 26 % of the new frame, both with one stored sample and with four{}.",
                  moving ? ", while the camera moves and turns" : ""),
      measured + " (1 and 4 stored)", "at most 26 %", ratios, 0, 1 / (1 - kMostShare)));
}

std::string turns_text(const std::string& scene) {
  return scene +
         ": in the first frames after turns of 5° to 50° the MSE is lower than after restarting accumulation, at equal "
         "time.";
}

void claim_turns(const SceneResult& scene, std::vector<Claim>& claims) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const Case& c : scene.cases) {
    ratios.push_back(early_ratio(c, 1));
    measured += fmt::format("{}{:.0f}°: {}", measured.empty() ? "" : ", ", c.step_deg, share_text(ratios.back()));
  }
  const bool of_paper = scene.name != "city";
  claims.push_back(judged_within(scene.name == "closed box" ? "turns-box"
                                 : scene.name == "Sponza"   ? "turns-sponza"
                                                            : "turns-city",
                                 of_paper ? kPaper : kOurs, turns_text(scene.name),
                                 measured + " of the MSE of restarted accumulation (1 stored)", kBelowOne, ratios, 0,
                                 1));
}

void claim_stored(const SceneResult& scene, std::vector<Claim>& claims) {
  const Case& c = scene.cases.front();
  const Ratio ratio = early_ratio(c, 2, 1);
  claims.push_back(judged_within(
      "four-stored", kPaper, "Four stored samples are at least as good as one.",
      fmt::format("{:.0f}° steps: {} with four, {} with one, of restarted accumulation: {} of it", c.step_deg,
                  share_text(early_ratio(c, 2)), share_text(early_ratio(c, 1)), share_text(ratio)),
      "four at most 5 % worse", {ratio}, 0, 1.05));
}

void claim_more_samples(const SceneResult& scene, std::vector<Claim>& claims) {
  const Case& c = scene.cases.front();
  if (c.traces.size() < 5) return;
  const Ratio ratio = early_ratio(c, 4, 2);
  claims.push_back(judged_within("more-samples", kPaper, "64 samples per step leave less error than 32.",
                                 share_text(ratio) + " of the MSE with 32 (4 stored)", kBelowOne, {ratio}, 0, 1));
}

/// Claim about the largest difference between bounds of the view dependency. The eye moves and turns: for pure
/// rotation, eq. 15 is zero and all bounds keep the same samples.
Claim claim_error_bound(const ExperimentContext& context, const ExperimentScene& scene, std::vector<Block>& blocks) {
  const int few = context.quick ? 8 : 32;
  const float step_deg = context.quick ? 20 : 5;
  const Reference reference = make_reference(context, scene);
  std::vector<TraceContender> list{contender(context, scene, 0, StoredSampleChoice::one, 0)};
  for (int k : {1, 4, 8})
    list.push_back(contender(context, scene, few, StoredSampleChoice::one, kSmallestError * static_cast<float>(k)));
  const Case c = measure(context, scene, reference, step_deg, list, kEyeStep_m * 100 / step_deg);
  blocks.emplace_back(trace_charts(
      "Bound of the view dependency",
      fmt::format("The box, one stored sample; the camera also moves by {:.0f} cm per step.", 100 * kEyeStep_m),
      c.traces, &TracePoint::mse, "MSE"));
  const Ratio four = early_ratio(c, 2, 1);
  const Ratio eight = early_ratio(c, 3, 1);
  return judged_within(
      "error-bound", kPaper, "Bounds of 1/256, 4/256 and 8/256 give the same error.",
      fmt::format("4/256: {}, 8/256: {} of the MSE with 1/256; the camera moves by {:.0f} cm per step of {:.0f}°",
                  share_text(four), share_text(eight), 100 * kEyeStep_m, step_deg),
      "within 10 %", {four, eight}, 1 / 1.1, 1.1);
}

Ratio ratio_named(const std::vector<SceneResult>& results, std::string_view name) {
  return early_ratio(named(results, "scene", name).cases.front(), 1);
}

Claim claim_lights_and_triangles(const ExperimentContext& context, const std::vector<SceneResult>& results,
                                 const Ratio& plain) {
  const char* const id = "light-and-triangles";
  const char* const text = "The kind of light and the number of triangles do not change how much reprojection helps.";
  const char* const threshold = "ratios within 0.67 and 1.5 of the box's";
  if (context.quick) return unmeasured(id, kPaper, text, threshold, "left out of a quick run");
  std::string measured = "box: " + share_text(plain);
  std::vector<Ratio> ratios;
  for (const SceneResult& result : results) {
    if (result.property != "light" && result.property != "triangles") continue;
    const Ratio ratio = early_ratio(result.cases.front(), 1);
    ratios.push_back(quotient(ratio, plain));
    measured += fmt::format(", {}: {}", result.name, share_text(ratio));
  }
  return judged_within(id, kPaper, text, measured, threshold, ratios, 0.67, 1.5);
}

Claim claim_materials(const ExperimentContext& context, const std::vector<SceneResult>& results, const Ratio& plain) {
  std::string measured = "box: " + share_text(plain);
  std::vector<Ratio> ratios;
  std::vector<const char*> names{"highly reflective"};
  if (!context.quick) names.push_back("glass");
  for (const char* name : names) {
    const Ratio ratio = ratio_named(results, name);
    ratios.push_back(quotient(ratio, plain));
    measured += fmt::format(", {}: {}", name, share_text(ratio));
  }
  return judged_within("materials", kPaper, "Reprojection helps less with highly reflective and refractive materials.",
                       measured + " of restarted accumulation", "ratios above the box's", ratios, 1);
}

/// Overheads, images and curves, in page order.
std::vector<Block> shown(std::vector<SceneResult>& results, const std::vector<Overhead>& overheads) {
  std::vector<Block> blocks{overhead_table(overheads)};
  std::vector<ImageSet> images;
  for (SceneResult& scene : results) images.push_back(std::move(scene.cases.front().images));
  blocks.emplace_back(
      trace_viewer("Images", "After the last step of a turn, at the time of four frames of restarted accumulation.",
                   std::move(images)));
  for (const SceneResult& scene : results) {
    for (const Case& c : scene.cases) {
      blocks.emplace_back(trace_charts(fmt::format("{}, steps of {:.0f}°", scene.name, c.step_deg),
                                       scene.property.empty() ? "Error after the last step of a turn of 100°."
                                                              : "A variation of the box: " + scene.property + ".",
                                       c.traces, &TracePoint::mse, "MSE"));
    }
  }
  return blocks;
}

ExperimentResult run_reprojection(const ExperimentContext& context) {
  const std::vector<float> steps = context.quick ? std::vector<float>{20, 50} : std::vector<float>{5, 10, 20, 50};
  const ExperimentScene box = closed_box();
  const std::optional<ExperimentScene> hall = sponza(context);
  std::vector<SceneResult> results;
  std::vector<Overhead> overheads;
  const auto measure_whole = [&](const ExperimentScene& scene, bool all) {
    results.push_back(measure_scene(context, scene, steps, all));
    for (const bool moving : {false, true}) overheads.push_back(measure_overhead(context, scene, moving));
  };
  measure_whole(box, true);
  if (hall) measure_whole(*hall, false);
  std::vector<BoxVariation> variations{BoxVariation::reflective};
  if (!context.quick) {
    measure_whole(city_street(), false);
    variations = {BoxVariation::point_light,  BoxVariation::directional_light, BoxVariation::triangles_80k,
                  BoxVariation::triangles_1m, BoxVariation::reflective,        BoxVariation::glass};
  }
  for (BoxVariation variation : variations)
    results.push_back(measure_scene(context, closed_box(variation), {steps.front()}, false));

  ExperimentResult result;
  for (const SceneResult& scene : results) {
    if (scene.property.empty()) claim_turns(scene, result.claims);
  }
  if (!hall) {
    result.claims.push_back(unmeasured("turns-sponza", kPaper, turns_text("Sponza"), kBelowOne, kNoSponza));
  }
  for (const bool moving : {false, true}) claim_overhead(overheads, moving, result.claims);
  claim_stored(results.front(), result.claims);
  claim_more_samples(results.front(), result.claims);
  std::vector<Block> bound_blocks;
  result.claims.push_back(claim_error_bound(context, box, bound_blocks));
  const Ratio plain = ratio_named(results, box.name);
  result.claims.push_back(claim_lights_and_triangles(context, results, plain));
  result.claims.push_back(claim_materials(context, results, plain));
  result.blocks = shown(results, overheads);
  result.blocks.insert(result.blocks.end(), bound_blocks.begin(), bound_blocks.end());
  result.setup = common_setup(context);
  result.setup.insert(result.setup.end(),
                      {{"Turn", "100° in steps; the last view is the same for all steps"},
                       {"First frames", "from the end of the first to the eighth frame of restarted accumulation"},
                       {"Repetitions", "three sequences (one in a quick run); contenders take turns frame by frame"}});
  return result;
}

}  // namespace

Experiment reprojection_experiment() {
  return {"reprojection", kPaper, "reusing samples across turns of the camera, against discarding them",
          run_reprojection};
}

}  // namespace relume
