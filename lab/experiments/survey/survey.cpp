#include "experiments/survey/survey.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "experiments/measure/pixel_mask.h"
#include "experiments/measure/settling.h"
#include "experiments/setup/apply_settings.h"
#include "experiments/setup/references.h"
#include "metrics/ensemble.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

constexpr int kFewestTimed = 3;  ///< frames of the trial run, beyond the first
constexpr int kMostTimed = 8;

/// A technique under measurement.
struct Running {
  RenderSettings settings;
  TechniqueValues values;
  int frames = 1;  ///< in the budget
  std::vector<double> mse = {};
  std::vector<double> times_s = {};
  Ensemble images = {};
  StillValues still = {};

  bool runs() const { return values.refused.empty() && values.failed.empty(); }
};

struct Survey {
  const ExperimentContext& context;
  const SurveyScene& scene;
  const SurveyEffort& effort;
  const RenderSettings& initial;  ///< settings with which sessions begin
  const FrameClock& clock;
  std::optional<TimedSession> timed = {};
  Reference before = {};
  Reference after = {};

  /// Begins a session, after the memory of an earlier one was freed.
  void open() {
    timed.reset();
    timed.emplace(scene.before.scene, initial, clock);
    session().shorten_preparation_on(context.stop);
  }

  Session& session() { return timed->session(); }

  void bring(bool changed) {
    session().set_camera(changed ? scene.camera_after : *scene.before.camera);
    session().set_time(changed ? scene.time_after_s : scene.before.settings.time_s);
  }

  void begin(const Running& r, int seed) {
    session().set_settings(r.settings);
    bring(false);
    timed->restart(seed);
  }

  void render(int frames) {
    for (int i = 0; i < frames; ++i) {
      context.check_stop();
      timed->render_frame();
    }
  }

  /// Runs a step of a technique that has not ended. An error ends the technique, and the survey continues.
  template <typename Step>
  void attempt(Running& r, const Step& step) {
    if (!r.runs()) return;
    try {
      step();
      return;
    } catch (const ExperimentStopped&) {
      throw;
    } catch (const DeviceMemoryError& error) {
      r.values.failed = error.what();
    } catch (const std::bad_alloc&) {
      r.values.failed = "out of memory";
    } catch (const std::exception& error) {
      r.values.failed = error.what();
    }
    open();
  }

  void plan(Running& r);
  void measure_still(Running& r, int repetition);
  void finish_still(Running& r);
  void prepare_change(bool changes, bool single);
  void measure_change(Running& r);
};

/// Determines the number of frames in the budget from a trial run. The first frame, in which techniques prepare, counts
/// in full.
void Survey::plan(Running& r) {
  try {
    begin(r, 0);
    render(1);
  } catch (const Error& error) {
    r.values.refused = error.what();
    return;
  }
  const double first_s = timed->frame_s().front();
  while (timed->frames() <= kFewestTimed || (timed->frames() <= kMostTimed && timed->time_s() < effort.budget_s))
    render(1);
  const double frame_s = median({timed->frame_s().begin() + 1, timed->frame_s().end()});
  const double more = frame_s > 0 ? (effort.budget_s - first_s) / frame_s : 0;
  r.frames = 1 + static_cast<int>(std::lround(std::clamp(more, 0.0, 1e6)));
  r.still.frame_ms = 1000 * frame_s;
}

void Survey::measure_still(Running& r, int repetition) {
  begin(r, 1 + repetition);
  render(r.frames);
  const Image image = session().image();
  const Metrics m = compute_metrics(image, before.image, {.tone_map = ToneMap::agx});
  const double weight = 1.0 / effort.repetitions;
  r.mse.push_back(m.mse - before.mse);
  r.still.rel_mse += weight * m.rel_mse;
  r.still.flip += weight * m.flip;
  r.times_s.push_back(timed->time_s());
  r.images.add(image);
  if (repetition > 0) return;
  r.still.image = image;
  r.still.rays = static_cast<double>(timed->rays()) / r.frames / static_cast<double>(image.pixels.size());
  // Without the spare memory that other techniques have left in the session.
  r.still.memory_bytes = buffer_table(session()).memory_bytes() + session().statistics().technique_bytes;
}

void Survey::finish_still(Running& r) {
  const ErrorSplit split = r.images.split(before.image, before.mse);
  r.still.mse = mean(r.mse);
  r.still.mse_interval = mean_interval(r.mse);
  r.still.rel_mse = without_noise(r.still.rel_mse, before.rel_mse);
  r.still.frames = static_cast<uint32_t>(r.frames);
  r.still.time_s = median(r.times_s);
  r.still.bias2 = {split.bias2, split.bias2_error};
  r.still.variance = split.variance;
  r.values.still = std::move(r.still);
}

/// Frames after a change show single samples where the history would start over: the mean of all frames since the
/// change hides how long a technique needs.
bool shows_single_frames(const RenderSettings& settings) {
  return settings.denoise == DenoiseChoice::none && settings.history == HistoryChoice::accumulate &&
         settings.allocation == AllocationChoice::uniform;
}

/// Renders the frames before the measured ones, and brings the state after the change. Sessions without a change render
/// these frames in that state where single frames are shown: cells and reservoirs that began with the measured frames
/// would differ by more than the change. Where images accumulate, their history starts over at the change, so that of
/// sessions without one begins with the measured frames.
void Survey::prepare_change(bool changes, bool single) {
  bring(!changes);
  if (!changes && !single) return;
  for (int i = 0; i < effort.warm_up; ++i) {
    context.check_stop();
    session().render_frame();
  }
  if (changes) bring(true);
}

void Survey::measure_change(Running& r) {
  RenderSettings settings = r.settings;
  const bool single = shows_single_frames(settings);
  if (single) settings.history = HistoryChoice::none;
  session().set_settings(settings);
  const PixelMask all = mask_of({"image"}, after.image.width, after.image.height);
  const auto measure = [&](bool changes, Ensemble& ghosts, Image* first) {
    const auto before_frame = [&](const ExperimentContext&, Session& s, int frame) {
      if (frame == 0) prepare_change(changes, single);
      if (frame != kGhostFrame) return;
      ghosts.add(s.image());
      if (first && ghosts.count() == 1) *first = s.image();
    };
    return measure_adaptation(context, fmt::format("{}, {}", scene.before.name, r.values.technique.name), session(),
                              effort.runs, effort.frames, after, all, {.before = before_frame});
  };
  ChangeValues values;
  Ensemble changed;
  Ensemble fresh;
  Settling settling{measure(true, changed, &values.image)};
  settling.fresh = measure(false, fresh, nullptr);
  if (const size_t frame = frames_until_settled(settling); frame > 0) values.lag = frame;
  const ErrorSplit a = changed.split(after.image, after.mse);
  const ErrorSplit b = fresh.split(after.image, after.mse);
  values.ghost.value = a.bias2 - b.bias2;
  if (a.bias2_error && b.bias2_error) values.ghost.error = std::hypot(*a.bias2_error, *b.bias2_error);
  r.values.change = std::move(values);
}

Reference reference_of(const ExperimentContext& context, const SurveyScene& scene, const SurveyEffort& effort,
                       bool changed) {
  ExperimentScene seen = scene.before;
  apply_settings(scene.reference, scene.before.name, seen.settings);
  if (changed) {
    seen.camera = scene.camera_after;
    seen.settings.time_s = scene.time_after_s;
  }
  return make_reference(context, seen, effort.reference_spp);
}

double mean_square(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) sum += static_cast<double>(pixel[c]) * static_cast<double>(pixel[c]);
  }
  return sum / (3.0 * static_cast<double>(image.pixels.size()));
}

std::vector<Running> running_of(const ExperimentContext& context, const SurveyScene& scene,
                                const std::vector<SurveyTechnique>& techniques) {
  std::vector<Running> list;
  for (const SurveyTechnique& technique : techniques) {
    Running r{.settings = scene.before.settings, .values = {.technique = technique, .slots = {}}};
    set_size_and_device(context, r.settings);
    apply_settings(technique.settings, technique.name, r.settings);
    r.values.slots = slots_of(r.settings);
    list.push_back(std::move(r));
  }
  return list;
}

}  // namespace

SurveyEffort SurveyEffort::of(const ExperimentContext& context) {
  if (!context.quick) return {};
  return {.budget_s = 0.01, .repetitions = 2, .runs = 2, .warm_up = 2, .frames = 6, .reference_spp = 16};
}

SceneValues measure_survey(const ExperimentContext& context, const SurveyScene& scene,
                           const std::vector<SurveyTechnique>& techniques, const SurveyEffort& effort,
                           const FrameClock& clock) {
  std::vector<Running> list = running_of(context, scene, techniques);
  Survey survey{context, scene, effort, list.front().settings, clock};
  survey.open();
  survey.before = reference_of(context, scene, effort, false);
  survey.after = reference_of(context, scene, effort, true);
  for (Running& r : list) survey.attempt(r, [&] { survey.plan(r); });
  for (int repetition = 0; repetition < effort.repetitions; ++repetition) {
    for (Running& r : list) survey.attempt(r, [&] { survey.measure_still(r, repetition); });
    context.report(scene.before.name + ", still images", (repetition + 1.0) / effort.repetitions);
  }
  SceneValues result{.name = scene.before.name, .change = scene.change, .techniques = {}};
  result.reference_settings = scene.reference;
  for (Running& r : list) {
    survey.attempt(r, [&] {
      survey.finish_still(r);
      if (keeps_state(r.settings)) survey.measure_change(r);
    });
    result.techniques.push_back(std::move(r.values));
  }
  result.mean_square = mean_square(survey.before.image);
  result.reference_mse = survey.before.mse;
  result.reference_spp = survey.before.spp;
  result.reference = std::move(survey.before.image);
  result.reference_after = std::move(survey.after.image);
  return result;
}

}  // namespace relume
