#include "experiments/measure/adapted_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "compare/timed_session.h"
#include "experiments/measure/adapted_file.h"
#include "experiments/setup/learning_scenes.h"
#include "render/build_pipeline.h"
#include "report/pictures.h"

namespace relume {
namespace {

/// A contender under way.
struct Running {
  TimedSession timed;
  bool learns = false;
  std::vector<PassTime> passes_before = {};
  std::vector<std::vector<double>> mse = {};  ///< by region, by frame of the present block
  AdaptedError result = {};
};

void measure_frame(Running& r, const Reference& reference, const std::vector<PixelMask>& regions, int block) {
  r.timed.render_frame();
  r.result.frame_s.push_back(r.timed.frame_s().back());
  r.result.last = r.timed.session().image();
  for (size_t i = 0; i < regions.size(); ++i) {
    r.mse[i].push_back(frame_mse(r.result.last, reference.image, regions[i]));
    if (r.mse[i].size() < static_cast<size_t>(block)) continue;
    r.result.mse[i].push_back(mean(r.mse[i]) - reference_noise(reference, regions[i]));
    r.mse[i].clear();
  }
}

/// Adds what passes took since `passes_before` to the contender's sums.
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

std::vector<Running> begin(const ExperimentScene& scene, const std::vector<NamedSettings>& contenders, size_t regions,
                           int seed) {
  std::vector<Running> running;
  for (const NamedSettings& contender : contenders) {
    RenderSettings settings = contender.settings;
    settings.history = HistoryChoice::none;
    settings.seed = seed;
    running.push_back({TimedSession(scene.scene, settings), learns(settings)});
    running.back().timed.session().set_camera(scene.camera);
    running.back().mse.resize(regions);
    running.back().result.name = contender.name;
    running.back().result.mse.resize(regions);
  }
  return running;
}

}  // namespace

std::vector<AdaptedError> measure_adapted(const ExperimentContext& context, const ExperimentScene& scene,
                                          const std::vector<NamedSettings>& contenders, const Reference& reference,
                                          const std::vector<PixelMask>& regions, const AdaptedOptions& options) {
  const std::filesystem::path file = adapted_file(context, scene, contenders, regions, options);
  if (std::optional<std::vector<AdaptedError>> kept = load_adapted(file)) return std::move(*kept);
  std::vector<Running> running = begin(scene, contenders, regions.size(), options.seed);
  const int all = options.warm_up + options.frames;
  for (int i = 0; i < options.sessions * all; ++i) {
    const int session = i / all;
    const int frame = i % all;
    for (Running& r : running) {
      context.check_stop();
      if (r.learns && frame == 0 && session > 0) r.timed.restart(options.seed + session);
      if (frame < options.warm_up) {
        if (r.learns || i == 0) r.timed.render_frame();
        continue;
      }
      if (frame == options.warm_up) r.passes_before = r.timed.session().statistics().passes;
      measure_frame(r, reference, regions, options.block);
      if (frame + 1 == all) add_pass_times(r);
    }
    context.report(scene.name, (i + 1.0) / (options.sessions * all));
  }
  std::vector<AdaptedError> results;
  for (Running& r : running) {
    for (auto& [pass, seconds] : r.result.pass_s) seconds /= options.sessions * options.frames;
    r.result.figures = r.timed.session().statistics().figures;
    results.push_back(std::move(r.result));
  }
  if (!file.empty()) save_adapted(file, results);
  return results;
}

ErrorRatio error_ratio(const std::vector<double>& a, const std::vector<double>& b) {
  const double mean_a = mean(a);
  const double mean_b = mean(b);
  ErrorRatio ratio;
  ratio.value = mean_b > 0 ? mean_a / mean_b : 0;
  // What is as near to the reference as the reference to the truth has no error to be told: nothing is decided.
  ratio.interval = {0, std::numeric_limits<double>::infinity(), 0};
  if (mean_b > 0) ratio.interval = {ratio.value, ratio.value, 0};
  if (a.size() < 2 || b.size() < 2 || !(mean_a > 0 && mean_b > 0)) return ratio;
  const auto relative_variance = [](const std::vector<double>& values, double m) {
    const double s = standard_deviation(values);
    return s * s / (m * m * static_cast<double>(values.size()));
  };
  const double var_a = relative_variance(a, mean_a);
  const double var_b = relative_variance(b, mean_b);
  const double freedom_a = static_cast<double>(a.size() - 1);
  const double freedom_b = static_cast<double>(b.size() - 1);
  const double sum = var_a + var_b;
  const double freedom = sum > 0 ? sum * sum / (var_a * var_a / freedom_a + var_b * var_b / freedom_b) : freedom_a;
  const double spread = std::exp(student_t(std::max<size_t>(static_cast<size_t>(freedom), 1)) * std::sqrt(sum));
  ratio.interval = {ratio.value / spread, ratio.value * spread, 0.95};
  return ratio;
}

ErrorRatio time_ratio(const AdaptedError& a, const AdaptedError& b) {
  if (!(b.median_s() > 0)) return {};
  const Interval of_a = median_interval(a.frame_s);
  const Interval of_b = median_interval(b.frame_s);
  const double spread = std::hypot(std::log(of_a.high / of_a.low), std::log(of_b.high / of_b.low)) / 2;
  const double value = a.median_s() / b.median_s();
  return {value, {value * std::exp(-spread), value * std::exp(spread), std::min(of_a.confidence, of_b.confidence)}};
}

ErrorRatio equal_time_ratio(const AdaptedError& a, const AdaptedError& b, size_t region) {
  const ErrorRatio error = error_ratio(a.mse[region], b.mse[region]);
  const ErrorRatio time = time_ratio(a, b);
  const double value = error.value * time.value;
  if (!(value > 0)) return {0, {0, std::numeric_limits<double>::infinity(), 0}};
  const auto both = [](double x, double y) { return std::exp(std::hypot(std::log(x), std::log(y))); };
  return {
      value,
      {value / both(error.value / error.interval.low, time.value / time.interval.low),
       value * both(error.interval.high / error.value, time.interval.high / time.value), error.interval.confidence}};
}

std::string to_text(const ErrorRatio& ratio) {
  return fmt::format("{:.3g}× ({:.3g} to {:.3g})", ratio.value, ratio.interval.low, ratio.interval.high);
}

Claim judged_ratios(std::string id, std::string paper, std::string claim, std::string measured,
                    const std::vector<ErrorRatio>& ratios, double least) {
  std::vector<const char*> verdicts;
  for (const ErrorRatio& ratio : ratios) verdicts.push_back(verdict_of(ratio.interval, least));
  return with_verdict(std::move(id), std::move(paper), std::move(claim), std::move(measured),
                      fmt::format("{}at least {:.2g}×, by the interval", ratios.size() > 1 ? "each " : "", least),
                      verdict_of_all(verdicts));
}

PictureSet adapted_pictures(const std::string& label, const std::vector<AdaptedError>& errors, const Image& reference) {
  std::vector<MeasuredImage> images;
  int color = 0;
  for (const AdaptedError& e : errors)
    images.push_back({e.name, color++, &e.last, fmt::format("MSE {:.2e}", e.mean_mse())});
  return measured_set(label, reference, images, {.values = false});
}

AdaptedOptions adapted_options(const ExperimentContext& context) {
  return {.warm_up = context.choose(128, 8),
          .frames = context.choose(64, 4),
          .sessions = context.choose(4, 2),
          .block = context.choose(32, 2)};
}

std::vector<std::pair<std::string, std::string>> adapted_setup(const ExperimentContext& context) {
  const AdaptedOptions o = adapted_options(context);
  std::vector<std::pair<std::string, std::string>> setup = learning_setup(context);
  setup.emplace_back("Frames", fmt::format("{} sessions with seeds of their own, {} frames to adapt and {} measured in "
                                           "each; what does not learn goes on in one session",
                                           o.sessions, o.warm_up, o.frames));
  setup.emplace_back("Intervals", fmt::format("95 %, from the means of {} blocks of {} frames",
                                              o.sessions * o.frames / o.block, o.block));
  setup.emplace_back("Times", "contenders take turns frame by frame");
  return setup;
}

}  // namespace relume
