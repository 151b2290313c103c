// [Schalk18 §4.3]: the camera turns by 100 degrees in steps; the error after the last step, and what a frame costs
// more.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/trace.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "experiments/setup/scenes.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schalk18 §4.3]";
constexpr float kSmallestError = 1.0f / 256;
constexpr float kEyeStep_m = 0.01f;  ///< of an eye that moves besides turning, a frame or a step of five degrees
constexpr const char* kOnce = "; one sequence";

struct Case {
  float step_deg;
  std::vector<Trace> traces;  ///< the first starts anew
  PictureSet pictures = {};
};

struct SceneResult {
  std::string name;
  std::string property;
  std::vector<Case> cases;  ///< the smallest step first
};

struct Overhead {
  std::string scene;
  bool moving = false;  ///< the eye moves, too: eq. 15 is evaluated
  double anew_ms = 0;
  double one_ms = 0;      ///< one stored sample
  double four_ms = 0;     ///< four
  double one_bytes = 0;   ///< a pixel, beyond what starting anew needs
  double four_bytes = 0;  ///< the same with four
};

TraceContender contender(const ExperimentContext& context, const ExperimentScene& scene, int samples_per_step,
                         StoredSampleChoice stored, float error) {
  TraceContender result{.name = samples_per_step == 0 ? "start anew" : "",
                        .settings = scene.settings,
                        .samples_per_step = samples_per_step};
  set_size(context, result.settings);
  if (samples_per_step == 0) return result;
  result.settings.history = HistoryChoice::reproject;
  result.settings.reproject.stored = stored;
  result.settings.reproject.error = error;
  result.name = fmt::format("{} stored, {} a step", stored == StoredSampleChoice::four ? 4 : 1, samples_per_step);
  if (error != kSmallestError) result.name += fmt::format(", ε {}/256", std::lround(error * 256));
  return result;
}

/// Contenders of one chart of the paper; what variations are about, one stored sample tells.
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

/// `aside_m`: how far the eye moves meanwhile.
Case measure(const ExperimentContext& context, const ExperimentScene& scene, const Reference& reference, float step_deg,
             const std::vector<TraceContender>& list, float aside_m = 0, int seed = 1) {
  const TraceOptions options{.turn = {100, step_deg, aside_m},
                             .frames = context.quick ? 16u : 64u,
                             .repetitions = 1,
                             .first_seed = seed,
                             .reference = &reference.image,
                             .reference_mse = reference.mse,
                             .picture_frame = 4};
  const std::string name = fmt::format("{}, {:.0f}°", scene.name, step_deg);
  std::vector<Trace> traces = trace(context, name, scene, list, options);
  PictureSet pictures = trace_pictures(name, traces, reference.image);
  return {step_deg, std::move(traces), std::move(pictures)};
}

SceneResult measure_scene(const ExperimentContext& context, const ExperimentScene& scene, std::vector<float> steps,
                          bool all) {
  const Reference reference = make_reference(context, scene);
  SceneResult result{scene.name, scene.property, {}};
  for (float step : steps) {
    const bool smallest = step == steps.front();  // which most claims are about
    result.cases.push_back(measure(context, scene, reference, step, contenders(context, scene, all && smallest)));
  }
  return result;
}

/// MSE against starting anew at equal time, over the first frames: from the end of the first frame to the eighth.
double early_ratio(const Case& c, size_t i) { return early_ratio(c.traces, i, 0, 8); }

/// Where the eye is if it moves: to and fro, so that it stays in the room.
float aside_at(int frame) {
  constexpr int kThereAndBack = 40;
  return kEyeStep_m * static_cast<float>(std::abs((frame + kThereAndBack / 2) % kThereAndBack - kThereAndBack / 2));
}

Overhead measure_overhead(const ExperimentContext& context, const ExperimentScene& scene, bool moving) {
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
    context.report(scene.name + (moving ? ", overhead of a moving eye" : ", overhead"), (frame + 1.0) / frames);
  }
  const auto usual_ms = [](const TimedSession& session) {
    return 1000 * median({session.frame_s().begin() + 4, session.frame_s().end()});
  };
  const auto pixel_bytes = [](const TimedSession& session) {
    const Statistics& s = session.session().statistics();
    const RenderSettings& settings = session.session().settings();
    return static_cast<double>(s.buffer_bytes + s.technique_bytes) / (double{1} * settings.width * settings.height);
  };
  const double anew_bytes = pixel_bytes(*sessions[0]);
  return {scene.name + (moving ? ", moving" : ""),
          moving,
          usual_ms(*sessions[0]),
          usual_ms(*sessions[1]),
          usual_ms(*sessions[2]),
          pixel_bytes(*sessions[1]) - anew_bytes,
          pixel_bytes(*sessions[2]) - anew_bytes};
}

TableBlock overhead_table(const std::vector<Overhead>& list) {
  TableBlock block{
      "Overhead",
      "Median time of a frame of one sample while the camera turns by 0.4° a frame; \"moving\": and moves by 1 cm, "
      "without which eq. 15 is zero and nothing is evaluated. The share is that of the new frame, as in the paper. "
      "Memory is what a pixel needs more; the paper's needs 144 bytes with "
      "one stored sample (133 MB).",
      "scene",
      {{"start anew, ms"}, {"1 stored, ms"}, {"share"}, {"bytes"}, {"4 stored, ms"}, {"share"}, {"bytes"}},
      {}};
  const auto share = [](double with, double without) {
    return TableCell{fmt::format("{:.0f} %", 100 * (1 - without / with)), 1 - without / with};
  };
  for (const Overhead& o : list) {
    block.rows.push_back({o.scene,
                          kNeutralColor,
                          {{fmt::format("{:.2f}", o.anew_ms), o.anew_ms},
                           {fmt::format("{:.2f}", o.one_ms), o.one_ms},
                           share(o.one_ms, o.anew_ms),
                           {fmt::format("{:.0f}", o.one_bytes), o.one_bytes},
                           {fmt::format("{:.2f}", o.four_ms), o.four_ms},
                           share(o.four_ms, o.anew_ms),
                           {fmt::format("{:.0f}", o.four_bytes), o.four_bytes}}});
  }
  return block;
}

void claim_overhead(const std::vector<Overhead>& list, bool moving, std::vector<Claim>& claims) {
  std::string measured;
  double worst = 0;
  for (const Overhead& o : list) {
    if (o.moving != moving) continue;
    const double one = 1 - o.anew_ms / o.one_ms;
    const double four = 1 - o.anew_ms / o.four_ms;
    worst = std::max({worst, one, four});
    measured +=
        fmt::format("{}{}: {:.0f} % and {:.0f} %", measured.empty() ? "" : "; ", o.scene, 100 * one, 100 * four);
  }
  claims.push_back(
      judged(moving ? "overhead-moving" : "overhead", kPaper,
             fmt::format("Reprojection takes 15 to 26 % of the new frame, with one stored sample as with four{}.",
                         moving ? ", while the camera moves as well as turns" : ""),
             measured + " (1 and 4 stored)", "at most 26 %", worst <= 0.26));
}

std::string turns_text(const std::string& scene) {
  return scene +
         ": in the first frames after turns of 5° to 50° the MSE is lower than after starting anew, at equal time.";
}

void claim_turns(const SceneResult& scene, std::vector<Claim>& claims) {
  std::string measured;
  double worst = 0;
  for (const Case& c : scene.cases) {
    const double ratio = early_ratio(c, 1);
    worst = std::max(worst, ratio);
    measured += fmt::format("{}{:.0f}°: {:.2f}", measured.empty() ? "" : ", ", c.step_deg, ratio);
  }
  claims.push_back(judged(scene.name == "closed box" ? "turns-box"
                          : scene.name == "Sponza"   ? "turns-sponza"
                                                     : "turns-city",
                          kPaper, turns_text(scene.name), measured + " of the MSE of starting anew (1 stored)" + kOnce,
                          "every ratio below 1", worst < 1));
}

void claim_stored(const SceneResult& scene, std::vector<Claim>& claims) {
  const Case& c = scene.cases.front();
  const double one = early_ratio(c, 1);
  const double four = early_ratio(c, 2);
  claims.push_back(judged(
      "four-stored", kPaper, "Four stored samples are at least as good as one.",
      fmt::format("{:.0f}° steps: {:.2f} with four, {:.2f} with one, of starting anew{}", c.step_deg, four, one, kOnce),
      "four at most 5 % worse", four <= 1.05 * one));
}

void claim_more_samples(const SceneResult& scene, std::vector<Claim>& claims) {
  const Case& c = scene.cases.front();
  if (c.traces.size() < 5) return;
  const double few = early_ratio(c, 2);
  const double many = early_ratio(c, 4);
  claims.push_back(
      judged("more-samples", kPaper, "64 samples a step leave less error than 32.",
             fmt::format("{:.2f} with 64, {:.2f} with 32, of starting anew (4 stored){}", many, few, kOnce),
             "64 below 32", many < few));
}

/// "1.02 (0.98 to 1.05)": the median of what sequences gave, and the ends.
std::string spread_text(std::vector<double> ratios) {
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  const std::string ends = fmt::format("{:.2f} to {:.2f}", *least, *most);
  return fmt::format("{:.2f} ({})", median(std::move(ratios)), ends);
}

/// The largest difference that other bounds of the view dependency make. The eye moves as well as turns: for one that
/// turns in its place eq. 15 is zero, and every bound keeps the same.
Claim claim_error_bound(const ExperimentContext& context, const ExperimentScene& scene, std::vector<Block>& blocks) {
  constexpr int kSequences = 3;
  const int few = context.quick ? 8 : 32;
  const float step_deg = context.quick ? 20 : 5;
  const Reference reference = make_reference(context, scene);
  std::vector<TraceContender> list{contender(context, scene, 0, StoredSampleChoice::one, 0)};
  for (int k : {1, 4, 8})
    list.push_back(contender(context, scene, few, StoredSampleChoice::one, kSmallestError * static_cast<float>(k)));
  std::vector<double> four;
  std::vector<double> eight;
  for (int seed = 1; seed <= kSequences; ++seed) {
    const Case c = measure(context, scene, reference, step_deg, list, kEyeStep_m * 100 / step_deg, seed);
    four.push_back(early_ratio(c, 2) / early_ratio(c, 1));
    eight.push_back(early_ratio(c, 3) / early_ratio(c, 1));
    if (seed > 1) continue;
    blocks.emplace_back(trace_charts(
        "Bound of the view dependency",
        fmt::format("The box, one stored sample; the eye moves by {:.0f} cm a step besides.", 100 * kEyeStep_m),
        c.traces, &TracePoint::mse, "MSE"));
  }
  return judged("error-bound", kPaper, "Bounds of 1/256, 4/256 and 8/256 give the same error.",
                fmt::format("4/256: {}, 8/256: {} of the MSE with 1/256; {} sequences, the eye moves by {:.0f} cm a "
                            "step of {:.0f}°",
                            spread_text(four), spread_text(eight), kSequences, 100 * kEyeStep_m, step_deg),
                "medians within 10 %", std::max(std::fabs(median(four) - 1), std::fabs(median(eight) - 1)) <= 0.1);
}

double ratio_named(const std::vector<SceneResult>& results, std::string_view name) {
  return early_ratio(named(results, name).cases.front(), 1);
}

void claim_properties(const ExperimentContext& context, const std::vector<SceneResult>& results,
                      const ExperimentScene& box, std::vector<Claim>& claims) {
  const std::string lights = "The kind of light and the number of triangles do not change how much reprojection helps.";
  const std::string materials = "Highly reflective and refractive materials make it help less.";
  if (context.quick) {
    claims.push_back(unmeasured("light-and-triangles", kPaper, lights, "ratios within 0.67 and 1.5 of the box's",
                                "left out of a quick run"));
  } else {
    const double plain = ratio_named(results, box.name);
    std::string measured = fmt::format("box: {:.2f}", plain);
    bool holds = true;
    for (const SceneResult& result : results) {
      if (result.property != "light" && result.property != "triangles") continue;
      const double ratio = early_ratio(result.cases.front(), 1);
      holds = holds && ratio / plain > 0.67 && ratio / plain < 1.5;
      measured += fmt::format(", {}: {:.2f}", result.name, ratio);
    }
    claims.push_back(judged("light-and-triangles", kPaper, lights, measured + kOnce,
                            "ratios within 0.67 and 1.5 of the box's", holds));
  }
  const double plain = ratio_named(results, box.name);
  const double reflective = ratio_named(results, "highly reflective");
  bool holds = reflective > plain;
  std::string measured = fmt::format("box: {:.2f}, highly reflective: {:.2f}", plain, reflective);
  if (!context.quick) {
    const double glass = ratio_named(results, "glass");
    holds = holds && glass > plain;
    measured += fmt::format(", glass: {:.2f}", glass);
  }
  claims.push_back(
      judged("materials", kPaper, materials, measured + " of starting anew" + kOnce, "ratios above the box's", holds));
}

/// Overheads, pictures and curves, in the page's order.
std::vector<Block> shown(std::vector<SceneResult>& results, const std::vector<Overhead>& overheads) {
  std::vector<Block> blocks{overhead_table(overheads)};
  std::vector<PictureSet> pictures;
  for (SceneResult& scene : results) pictures.push_back(std::move(scene.cases.front().pictures));
  blocks.emplace_back(
      trace_viewer("Pictures", "After the last step of a turn, and as much time as four frames of starting anew take.",
                   std::move(pictures)));
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
    result.claims.push_back(unmeasured("turns-sponza", kPaper, turns_text("Sponza"), "every ratio below 1", kNoSponza));
  }
  for (const bool moving : {false, true}) claim_overhead(overheads, moving, result.claims);
  claim_stored(results.front(), result.claims);
  claim_more_samples(results.front(), result.claims);
  std::vector<Block> bound_blocks;
  result.claims.push_back(claim_error_bound(context, box, bound_blocks));
  claim_properties(context, results, box, result.claims);
  result.blocks = shown(results, overheads);
  result.blocks.insert(result.blocks.end(), bound_blocks.begin(), bound_blocks.end());
  result.setup = common_setup(context);
  result.setup.insert(result.setup.end(),
                      {{"Turn", "100° in steps; the last view is the same whatever the step"},
                       {"First frames", "from the end of the first to the eighth frame of starting anew"},
                       {"Repetitions",
                        "one sequence each, three of the bound of the view dependency; contenders take turns frame by "
                        "frame"}});
  return result;
}

}  // namespace

Experiment reprojection_experiment() {
  return {"reprojection", kPaper, "taking samples along when the camera turns, against starting anew",
          run_reprojection};
}

}  // namespace relume
