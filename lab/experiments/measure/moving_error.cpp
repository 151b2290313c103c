#include "experiments/measure/moving_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "experiments/measure/moving_file.h"
#include "experiments/setup/apply_settings.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

constexpr int kTimingRounds = 2;  // before the measurement

/// The camera `steps` after the scene's view.
std::optional<CameraPose> moved_camera(const ExperimentScene& scene, const MovingOptions& options, float steps) {
  return turned_ahead(scene, steps * options.step_deg, steps * options.step_m);
}

/// Time of the animation `steps` after the scene's view, in seconds.
float moved_time(const ExperimentScene& scene, const MovingOptions& options, float steps) {
  return scene.settings.time_s + (steps + 1) * options.animation_step_s;
}

/// Session shared by all contenders: one scene per contender could exhaust memory.
struct Walk {
  const ExperimentContext& context;
  const ExperimentScene& scene;
  const MovingOptions& options;
  const std::vector<Reference>& references;
  TimedSession timed;

  void begin(const MovingContender& contender, int seed) {
    RenderSettings settings = contender.settings;
    set_size_and_device(context, settings);
    timed.session().set_settings(settings);
    move(-1);
    timed.restart(seed);
  }

  /// Brings camera and animation to their states `steps` after the scene's view.
  void move(float steps) {
    timed.session().set_camera(moved_camera(scene, options, steps));
    if (options.animation_step_s > 0) timed.session().set_time(moved_time(scene, options, steps));
  }

  /// Moves from the previous view to this one. Returns the time in ms.
  double move_to(int view, int frames) {
    for (int i = 1; i <= frames; ++i) {
      context.check_stop();
      const float share = static_cast<float>(i) / static_cast<float>(frames);
      move(static_cast<float>(view - 1) + share);
      timed.render_frame();
    }
    const auto& seconds = timed.frame_s();
    return 1000 * std::accumulate(seconds.end() - frames, seconds.end(), 0.0);
  }

  /// Median time per frame, without the first quarter, which fills caches.
  double frame_ms() const {
    const auto& seconds = timed.frame_s();
    return 1000 * median({seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 4), seconds.end()});
  }

  void measure(int view, int repetitions, MovingError& error) {
    error.last = timed.session().image();
    const Reference& reference = references[static_cast<size_t>(view)];
    const Metrics m = compute_metrics(error.last, reference.image, {.tone_map = ToneMap::agx});
    const double weight = 1.0 / (options.views * repetitions);
    const double mse = without_noise(m.mse, reference.mse);
    error.mses.back() += mse / options.views;
    error.flips.back() += m.flip / options.views;
    error.mse += mse * weight;
    error.flip += m.flip * weight;
  }
};

std::vector<Reference> render_references(const ExperimentContext& context, const ExperimentScene& scene,
                                         const MovingOptions& options) {
  ExperimentScene seen = plainly_sampled(scene);
  apply_settings(options.reference, scene.name, seen.settings);
  std::vector<ReferencePose> poses;
  for (int view = 0; view < options.views; ++view) {
    const auto steps = static_cast<float>(view);
    poses.push_back({moved_camera(scene, options, steps), moved_time(scene, options, steps)});
  }
  return make_references(context, seen, poses, options.reference_spp);
}

MovingErrors measure(const ExperimentContext& context, const ExperimentScene& scene,
                     const std::vector<MovingContender>& contenders, const MovingOptions& options,
                     const std::vector<Reference>& references) {
  RenderSettings first = contenders.front().settings;
  set_size_and_device(context, first);
  Walk walk{context, scene, options, references, TimedSession(scene.scene, first, options.clock)};
  walk.timed.session().shorten_preparation_on(context.stop);
  MovingErrors result{scene.name, {}, references.back().image};
  for (const Reference& reference : references) result.reference_mse += reference.mse / options.views;
  const auto repetitions_of = [&](const MovingContender& c) { return std::max(options.repetitions, c.repetitions); };
  int most = 0;
  double rounds = 0;
  for (const MovingContender& contender : contenders) {
    most = std::max(most, repetitions_of(contender));
    rounds += kTimingRounds + repetitions_of(contender);
  }
  double done = 0;
  std::vector<std::vector<double>> frame_ms(contenders.size());
  for (const MovingContender& contender : contenders) result.contenders.push_back({.name = contender.name});
  for (int round = 0; round < kTimingRounds; ++round) {
    for (size_t i = 0; i < contenders.size(); ++i) {
      walk.begin(contenders[i], 0);
      walk.move_to(0, options.frames);
      frame_ms[i].push_back(walk.frame_ms());
      context.report(scene.name, ++done / rounds);
    }
  }
  std::vector<std::vector<double>> leg_ms(contenders.size());
  for (int repetition = 1; repetition <= most; ++repetition) {
    const double budget_ms = options.frames * median(frame_ms.front());
    for (size_t i = 0; i < contenders.size(); ++i) {
      const int repetitions = repetitions_of(contenders[i]);
      if (repetition > repetitions) continue;
      MovingError& error = result.contenders[i];
      error.frames = options.equal_frames ? options.frames
                                          : std::max(1, static_cast<int>(std::lround(budget_ms / median(frame_ms[i]))));
      walk.begin(contenders[i], repetition);
      error.mses.push_back(0);
      error.flips.push_back(0);
      for (int view = 0; view < options.views; ++view) {
        leg_ms[i].push_back(walk.move_to(view, error.frames));
        walk.measure(view, repetitions, error);
      }
      frame_ms[i].push_back(walk.frame_ms());
      context.report(scene.name, ++done / rounds);
    }
  }
  for (size_t i = 0; i < contenders.size(); ++i)
    result.contenders[i].time_share = median(leg_ms[i]) / median(leg_ms.front());
  return result;
}

}  // namespace

MovingErrors measure_moving(const ExperimentContext& context, const ExperimentScene& scene,
                            const std::vector<MovingContender>& contenders, const MovingOptions& options) {
  const std::filesystem::path file = moving_file(context, scene, contenders, options);
  const auto load = [&](const ExperimentContext&) { return load_moving(file); };
  if (std::optional<MovingErrors> kept = measure_on_first(context, scene.name, load)) return std::move(*kept);
  const std::vector<Reference> references = render_references(context, scene, options);
  return measure_on_first(context, scene.name, [&](const ExperimentContext& own) {
    MovingErrors errors = measure(own, scene, contenders, options, references);
    if (!file.empty()) save_moving(file, errors);
    return errors;
  });
}

}  // namespace relume
