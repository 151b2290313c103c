#include "experiments/measure/trace.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "experiments/measure/trace_file.h"
#include "metrics/metrics.h"
#include "metrics/statistics.h"
#include "report/pictures.h"

namespace relume {
namespace {

/// A contender on its way: its session, and its points in each repetition.
struct Runner {
  const TraceContender* contender;
  std::unique_ptr<TimedSession> session;
  std::vector<std::vector<TracePoint>> repetitions = {};
  uint32_t frames = 0;  ///< at the last view
  double time_s = 0;
  double samples_before = 0;
  Image picture = {};
  TracePoint picture_point = {};
  std::vector<float> map = {};
};

/// The camera when `degrees` of the way are left.
std::optional<PlacedCamera> camera_on(const Turn& way, const ExperimentScene& scene, float degrees) {
  return turned_aside(scene, -degrees, way.aside_m * degrees / way.total_deg);
}

/// Turns the camera and renders the steps before the last view.
void turn(const ExperimentContext& context, Runner& runner, const ExperimentScene& scene, const Turn& turn) {
  Session& session = runner.session->session();
  const bool sees_steps = turn.step_deg > 0 && runner.contender->samples_per_step > 0;
  const int steps = sees_steps ? static_cast<int>(std::lround(turn.total_deg / turn.step_deg)) : 0;
  for (int i = 0; i < steps; ++i) {
    session.set_camera(camera_on(turn, scene, turn.total_deg - static_cast<float>(i) * turn.step_deg));
    for (int k = 0; k < runner.contender->samples_per_step; ++k) {
      context.check_stop();
      runner.session->render_frame();
    }
  }
  session.set_camera(scene.camera);
}

void restart(const ExperimentContext& context, Runner& runner, const ExperimentScene& scene, const Turn& way,
             int seed) {
  // Begins at the first view, so that the first frame knows of no motion.
  runner.session->session().set_camera(
      camera_on(way, scene, way.step_deg > 0 && runner.contender->samples_per_step > 0 ? way.total_deg : 0.0f));
  runner.session->restart(seed);
  turn(context, runner, scene, way);
  runner.frames = 0;
  runner.time_s = 0;
  runner.samples_before = runner.session->samples_per_pixel();
  runner.repetitions.emplace_back();
}

TracePoint point_of(const Runner& runner, const Image& image, const TraceOptions& options) {
  const double mse = compute_metrics(image, *options.reference, {.flip = false}).mse;
  return {static_cast<double>(runner.frames), runner.session->samples_per_pixel() - runner.samples_before,
          runner.time_s, without_noise(mse, options.reference_mse), distance_spread(image, *options.reference)};
}

void render(Runner& runner, const TraceOptions& options) {
  runner.session->render_frame();
  ++runner.frames;
  runner.time_s += runner.session->frame_s().back();
  if (!is_measured(runner.frames)) return;
  runner.repetitions.back().push_back(point_of(runner, runner.session->session().image(), options));
}

void take_pictures(std::vector<Runner>& runners, const TraceOptions& options) {
  for (Runner& runner : runners) {
    runner.picture = runner.session->session().image();
    runner.picture_point = point_of(runner, runner.picture, options);
  }
}

void take_maps(std::vector<Runner>& runners) {
  for (Runner& runner : runners) {
    if (!runner.contender->map.empty())
      runner.map = runner.session->session().aov(runner.contender->map).front().values;
  }
}

Trace median_trace(const Runner& runner) {
  Trace trace{runner.contender->name, {}, runner.picture, runner.picture_point, runner.map};
  size_t count = runner.repetitions.front().size();
  for (const auto& points : runner.repetitions) count = std::min(count, points.size());
  for (size_t i = 0; i < count; ++i) {
    TracePoint point;
    for (double TracePoint::*member :
         {&TracePoint::frames, &TracePoint::samples, &TracePoint::time_s, &TracePoint::mse, &TracePoint::spread}) {
      std::vector<double> values;
      for (const auto& points : runner.repetitions) values.push_back(points[i].*member);
      point.*member = median(std::move(values));
    }
    trace.points.push_back(point);
  }
  return trace;
}

}  // namespace

double distance_spread(const Image& image, const Image& reference) {
  check_same_size(image, reference);
  double sum = 0;
  double squares = 0;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgb a = glm::clamp(image.pixels[i], Rgb(0), Rgb(1));
    const Rgb b = glm::clamp(reference.pixels[i], Rgb(0), Rgb(1));
    const double distance = glm::distance(a, b);
    sum += distance;
    squares += distance * distance;
  }
  const double n = static_cast<double>(image.pixels.size());
  return squares / n - sum / n * sum / n;
}

std::vector<Trace> trace(const ExperimentContext& context, const std::string& stage, const ExperimentScene& scene,
                         const std::vector<TraceContender>& contenders, const TraceOptions& options) {
  const std::filesystem::path file = trace_file(context, scene, contenders, options);
  if (std::optional<std::vector<Trace>> kept = load_traces(file)) return std::move(*kept);
  std::vector<Runner> runners;
  for (const TraceContender& contender : contenders) {
    context.check_stop();
    runners.push_back({&contender, std::make_unique<TimedSession>(scene.scene, contender.settings, options.clock)});
  }
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (size_t i = 0; i < runners.size(); ++i) {
      restart(context, runners[i], scene, options.turn, options.first_seed + repetition);
      context.report(stage, (repetition + 0.6 * static_cast<double>(i + 1) / static_cast<double>(runners.size())) /
                                options.repetitions);
    }
    for (uint32_t frame = 0; frame < options.frames; ++frame) {
      render(runners.front(), options);
      for (size_t i = 1; i < runners.size(); ++i) {
        // Not so many that a technique whose frames cost nothing never ends.
        while (runners[i].time_s < runners.front().time_s && runners[i].frames < 8 * (frame + 1)) {
          context.check_stop();
          render(runners[i], options);
        }
      }
      if (repetition == 0 && frame + 1 == options.picture_frame) take_pictures(runners, options);
    }
    if (repetition == 0) take_maps(runners);
    context.report(stage, (repetition + 1.0) / options.repetitions);
  }
  std::vector<Trace> traces;
  for (const Runner& runner : runners) traces.push_back(median_trace(runner));
  if (!file.empty() && options.picture_frame > 0) save_traces(file, traces);
  return traces;
}

double value_at(const Trace& trace, TraceValue value, double time_s) {
  const auto& points = trace.points;
  if (points.empty()) return 0;
  if (time_s <= points.front().time_s) return points.front().*value;
  for (size_t i = 1; i < points.size(); ++i) {
    if (time_s > points[i].time_s) continue;
    const double span = std::log(points[i].time_s / points[i - 1].time_s);
    const double t = span > 0 ? std::log(time_s / points[i - 1].time_s) / span : 1;
    return std::exp((1 - t) * std::log(std::max(points[i - 1].*value, 1e-30)) +
                    t * std::log(std::max(points[i].*value, 1e-30)));
  }
  return points.back().*value;
}

double mean_ratio(const Trace& a, const Trace& b, TraceValue value, double begin_s, double end_s) {
  constexpr int kTimes = 16;
  double sum = 0;
  for (int i = 0; i < kTimes; ++i) {
    const double time_s = begin_s * std::pow(end_s / begin_s, i / (kTimes - 1.0));
    sum += std::log(std::max(value_at(a, value, time_s), 1e-30) / std::max(value_at(b, value, time_s), 1e-30));
  }
  return std::exp(sum / kTimes);
}

double early_ratio(const std::vector<Trace>& traces, size_t a, size_t b, double frames) {
  const auto& points = traces.front().points;
  const auto end = std::find_if(points.begin(), points.end(), [&](const TracePoint& p) { return p.frames >= frames; });
  const double end_s = end == points.end() ? points.back().time_s : end->time_s;
  const double begin_s =
      std::max({points.front().time_s, traces[a].points.front().time_s, traces[b].points.front().time_s});
  return mean_ratio(traces[a], traces[b], &TracePoint::mse, begin_s, end_s);
}

ChartBlock trace_charts(std::string title, std::string text, const std::vector<Trace>& traces, TraceValue value,
                        const std::string& label) {
  ChartBlock block{std::move(title), std::move(text), {}};
  Chart by_time{"by time", "time since the last change, ms", label, true, true, {}};
  Chart by_frames{"by frames", "frames since the last change", label, true, true, {}};
  for (size_t i = 0; i < traces.size(); ++i) {
    Curve time{traces[i].name, static_cast<int>(i), false, {}};
    Curve frames = time;
    for (const TracePoint& p : traces[i].points) {
      time.points.push_back({.x = 1000 * p.time_s, .y = p.*value});
      frames.points.push_back({.x = p.frames, .y = p.*value});
    }
    by_time.curves.push_back(std::move(time));
    by_frames.curves.push_back(std::move(frames));
  }
  block.charts = {std::move(by_time), std::move(by_frames)};
  return block;
}

PictureSet trace_pictures(const std::string& label, const std::vector<Trace>& traces, const Image& reference) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < traces.size(); ++i) {
    const Trace& t = traces[i];
    images.push_back({t.name, static_cast<int>(i), &t.picture,
                      fmt::format("{:.0f} ms, {:.3g} samples, MSE {:.2e}", 1000 * t.picture_point.time_s,
                                  t.picture_point.samples, t.picture_point.mse)});
  }
  PictureSet set = measured_set(label, reference, images, {.values = false});
  for (size_t i = 0; i < traces.size(); ++i) {
    if (traces[i].map.empty()) continue;
    set.pictures.push_back(
        map_picture(traces[i].name + ", map", static_cast<int>(i), traces[i].map, reference.width, reference.height));
  }
  return set;
}

ViewerBlock trace_viewer(std::string title, std::string text, std::vector<PictureSet> sets) {
  return {std::move(title), std::move(text), picture_layer_kinds(), std::move(sets)};
}

}  // namespace relume
