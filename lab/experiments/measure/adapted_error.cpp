#include "experiments/measure/adapted_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compare/timed_session.h"
#include "experiments/measure/adapted_file.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/shared_parts.h"
#include "render/build_pipeline.h"
#include "report/images.h"

namespace relume {
namespace {

/// State that a technique keeps between frames.
enum class Keeps {
  nothing,   ///< none: one session suffices
  prepared,  ///< random preparation before the first frame, fixed afterwards
  learned,   ///< what samples of earlier frames have taught it, or cells with their light
  samples,   ///< samples of earlier frames, which the image shows again
};

Keeps kept_by(const RenderSettings& settings) {
  if (settings.reuse != ReuseChoice::none && settings.reuse != ReuseChoice::ris) return Keeps::samples;
  if (learns(settings) || settings.cache != CacheChoice::none) return Keeps::learned;
  return settings.lights == LightSelectionChoice::static_lists ? Keeps::prepared : Keeps::nothing;
}

/// State of a contender during the measurement.
struct Running {
  TimedSession timed;
  Keeps keeps = Keeps::nothing;
  std::vector<PassTime> passes_before = {};
  uint64_t rays = 0;                          ///< of the measured frames
  std::vector<std::vector<double>> mse = {};  ///< by region, by frame of the current block
  AdaptedError result = {};
};

void measure_frame(Running& r, const Reference& reference, const std::vector<PixelMask>& regions,
                   const AdaptedOptions& options) {
  // All frames of a session share its random preparation or, over tens of frames, its samples.
  const int block = r.keeps == Keeps::prepared || r.keeps == Keeps::samples ? options.frames : options.block;
  const uint64_t rays_before = r.timed.rays();
  r.timed.render_frame();
  r.rays += r.timed.rays() - rays_before;
  r.result.frame_s.push_back(r.timed.frame_s().back());
  r.result.last = r.timed.session().image();
  for (size_t i = 0; i < regions.size(); ++i) {
    r.mse[i].push_back(frame_mse(r.result.last, reference.image, regions[i]));
    if (r.mse[i].size() < static_cast<size_t>(block)) continue;
    r.result.mse[i].push_back(mean(r.mse[i]) - reference_noise(reference, regions[i]));
    r.mse[i].clear();
  }
}

/// Adds pass times since `passes_before` to the contender's sums.
void add_pass_times(Running& r) {
  auto& sums = r.result.pass_s;
  for (const PassTime& pass : pass_times_since(r.timed.session().statistics().passes, r.passes_before)) {
    const auto sum = std::find_if(sums.begin(), sums.end(), [&](const auto& s) { return s.first == pass.name; });
    if (sum == sums.end()) {
      sums.emplace_back(pass.name, pass.seconds);
    } else {
      sum->second += pass.seconds;
    }
  }
}

/// Whether the technique needs this warm-up frame.
bool needs_frame(Keeps keeps, int session, int frame) {
  return keeps == Keeps::learned || keeps == Keeps::samples ||
         (frame == 0 && (keeps == Keeps::prepared || session == 0));
}

std::vector<Running> begin(const ExperimentContext& context, const ExperimentScene& scene,
                           const std::vector<NamedSettings>& contenders, size_t regions, int seed) {
  std::vector<Running> running;
  for (const NamedSettings& contender : contenders) {
    context.check_stop();
    RenderSettings settings = contender.settings;
    settings.history = HistoryChoice::none;
    settings.seed = seed;
    running.push_back({TimedSession(scene.scene, settings), kept_by(settings)});
    running.back().timed.session().shorten_preparation_on(context.stop);
    running.back().timed.session().set_camera(scene.camera);
    running.back().mse.resize(regions);
    running.back().result.name = contender.name;
    running.back().result.mse.resize(regions);
  }
  return running;
}

std::vector<AdaptedError> measure_alone(const ExperimentContext& context, const ExperimentScene& scene,
                                        const std::vector<NamedSettings>& contenders, const Reference& reference,
                                        const std::vector<PixelMask>& regions, const AdaptedOptions& options) {
  const std::filesystem::path file = adapted_file(context, scene, contenders, regions, options);
  if (std::optional<std::vector<AdaptedError>> kept = load_adapted(file)) return std::move(*kept);
  std::vector<Running> running = begin(context, scene, contenders, regions.size(), options.seed);
  const int all = options.warm_up + options.frames;
  for (int i = 0; i < options.sessions * all; ++i) {
    const int session = i / all;
    const int frame = i % all;
    for (Running& r : running) {
      context.check_stop();
      if (r.keeps != Keeps::nothing && frame == 0 && session > 0) r.timed.restart(options.seed + session);
      if (frame < options.warm_up) {
        if (needs_frame(r.keeps, session, frame)) r.timed.render_frame();
        continue;
      }
      if (frame == options.warm_up) r.passes_before = r.timed.session().statistics().passes;
      measure_frame(r, reference, regions, options);
      if (frame + 1 == all) add_pass_times(r);
    }
    context.report(scene.name, (i + 1.0) / (options.sessions * all));
  }
  std::vector<AdaptedError> results;
  for (Running& r : running) {
    for (auto& [pass, seconds] : r.result.pass_s) seconds /= options.sessions * options.frames;
    r.result.figures = r.timed.session().statistics().pass_statistics;
    r.result.rays = static_cast<double>(r.rays) / static_cast<double>(options.sessions * options.frames) /
                    static_cast<double>(r.result.last.pixels.size());
    results.push_back(std::move(r.result));
  }
  if (!file.empty()) save_adapted(file, results);
  return results;
}

}  // namespace

std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<NamedSettings>& contenders, const Reference& reference,
                                          const std::vector<PixelMask>& regions, const AdaptedOptions& options) {
  return measure_on_first(context, scene.name, [&](const ExperimentContext& own) {
    return measure_alone(own, scene, contenders, reference, regions, options);
  });
}

Ratio time_ratio(const AdaptedError& a, const AdaptedError& b) { return time_ratio(a.frame_s, b.frame_s); }

Ratio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region) {
  return product(error_ratio(a.mse[region], b.mse[region]), time_ratio(a, b));
}

ImageSet adapted_images(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference) {
  std::vector<MeasuredImage> images;
  int color = 0;
  for (const AdaptedError& e : errors)
    images.push_back({e.name, color++, &e.last, fmt::format("MSE {:.2e}", e.mean_mse())});
  return measured_set(label, reference, images, {.values = false});
}

AdaptedOptions adapted_options(const ExperimentContext& context, int scale) {
  if (!context.quick && scale >= 5) return {.warm_up = 24, .frames = 4, .sessions = 2, .block = 2};
  if (!context.quick && scale > 1) return {.warm_up = 48, .frames = 16, .sessions = 2, .block = 8};
  return {.warm_up = context.choose(128, 8),
          .frames = context.choose(64, 4),
          .sessions = context.choose(4, 2),
          .block = context.choose(32, 2)};
}

std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context) {
  const AdaptedOptions o = adapted_options(context);
  std::vector<std::pair<std::string, std::string>> setup = learning_setup(context);
  setup.emplace_back("Frames", fmt::format("{} sessions with separate seeds, {} frames to adapt and {} measured in "
                                           "each; techniques that neither adapt nor prepare use one session",
                                           o.sessions, o.warm_up, o.frames));
  setup.emplace_back("Intervals",
                     fmt::format("95 %, from the means of {} blocks of {} frames; of static lists from {} sessions",
                                 o.sessions * o.frames / o.block, o.block, o.sessions));
  setup.emplace_back("Times", "contenders take turns frame by frame");
  return setup;
}

}  // namespace relume
