#include "experiments/measure/trace.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/srgb.h"
#include "experiments/measure/trace_file.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"
#include "relume/lab/metrics.h"
#include "report/images.h"

namespace relume {
namespace {

/// State of a contender: its session, and its points in each repetition.
struct Runner {
  const TraceContender* contender;
  std::unique_ptr<TimedSession> session;
  std::vector<std::vector<TracePoint>> repetitions = {};
  uint32_t frames = 0;  ///< at the last view
  double time_s = 0;
  double samples_before = 0;
  Image image = {};
  TracePoint image_point = {};
  std::vector<float> map = {};
};

/// Camera at `degrees` before the last view.
std::optional<CameraPose> camera_on(const Turn& way, const ExperimentScene& scene, float degrees) {
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
  // Starts at the first rendered view, so that the first frame has no motion.
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
  return {static_cast<double>(runner.frames),
          runner.session->samples_per_pixel() - runner.samples_before,
          runner.time_s,
          without_noise(mse, options.reference_mse),
          distance_spread(image, *options.reference),
          display_error(image, *options.reference)};
}

void render(Runner& runner, const TraceOptions& options) {
  runner.session->render_frame();
  ++runner.frames;
  runner.time_s += runner.session->frame_s().back();
  if (!is_measured(runner.frames)) return;
  runner.repetitions.back().push_back(point_of(runner, runner.session->session().image(), options));
}

void take_images(std::vector<Runner>& runners, const TraceOptions& options) {
  for (Runner& runner : runners) {
    runner.image = runner.session->session().image();
    runner.image_point = point_of(runner, runner.image, options);
  }
}

void take_maps(std::vector<Runner>& runners) {
  for (Runner& runner : runners) {
    if (!runner.contender->map.empty())
      runner.map = runner.session->session().aov(runner.contender->map).front().values;
  }
}

/// Adds the last frame as a point if the grid of frames ended earlier.
void end_repetition(Runner& runner, const TraceOptions& options) {
  if (!is_measured(runner.frames))
    runner.repetitions.back().push_back(point_of(runner, runner.session->session().image(), options));
}

std::vector<Trace> measure_traces(const ExperimentContext& context, const std::string& stage,
                                  const ExperimentScene& scene, const std::vector<TraceContender>& contenders,
                                  const TraceOptions& options) {
  const std::filesystem::path file = trace_file(context, scene, contenders, options);
  if (std::optional<std::vector<Trace>> kept = load_traces(file)) return std::move(*kept);
  std::vector<Runner> runners;
  for (const TraceContender& contender : contenders) {
    context.check_stop();
    runners.push_back({&contender, std::make_unique<TimedSession>(scene.scene, contender.settings, options.clock)});
    runners.back().session->session().shorten_preparation_on(context.stop);
  }
  for (int repetition = 0; repetition < options.repetitions; ++repetition) {
    for (size_t i = 0; i < runners.size(); ++i) {
      restart(context, runners[i], scene, options.turn, 1 + repetition);
      context.report(stage, (repetition + 0.6 * static_cast<double>(i + 1) / static_cast<double>(runners.size())) /
                                options.repetitions);
    }
    for (uint32_t frame = 0; frame < options.frames; ++frame) {
      render(runners.front(), options);
      for (size_t i = 1; i < runners.size(); ++i) {
        // Bounds the frame count, so that techniques with very fast frames also end.
        while (runners[i].time_s < runners.front().time_s && runners[i].frames < 8 * (frame + 1)) {
          context.check_stop();
          render(runners[i], options);
        }
      }
      if (repetition == 0 && frame + 1 == options.image_frame) take_images(runners, options);
    }
    if (repetition == 0) take_maps(runners);
    for (Runner& runner : runners) end_repetition(runner, options);
    context.report(stage, (repetition + 1.0) / options.repetitions);
  }
  std::vector<Trace> traces;
  for (Runner& runner : runners) {
    traces.push_back({runner.contender->name,
                      std::move(runner.repetitions),
                      {},
                      std::move(runner.image),
                      runner.image_point,
                      std::move(runner.map)});
    traces.back().points = median_points(traces.back().repetitions);
  }
  if (!file.empty() && options.image_frame > 0) save_traces(file, traces);
  return traces;
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

double display_error(const Image& image, const Image& reference) {
  check_same_size(image, reference);
  double sum = 0;
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const Rgb a = srgb_from_linear(glm::clamp(image.pixels[i], Rgb(0), Rgb(1)));
    const Rgb b = srgb_from_linear(glm::clamp(reference.pixels[i], Rgb(0), Rgb(1)));
    sum += static_cast<double>(glm::dot(a - b, a - b)) / 3;
  }
  return sum / static_cast<double>(image.pixels.size());
}

std::vector<Trace> trace(const ExperimentContext& context, const std::string& stage, const ExperimentScene& scene,
                         const std::vector<TraceContender>& contenders, const TraceOptions& options) {
  return measure_on_first(context, stage, [&](const ExperimentContext& own) {
    return measure_traces(own, stage, scene, contenders, options);
  });
}

TracePoints median_points(const std::vector<TracePoints>& repetitions) {
  TracePoints result;
  size_t count = repetitions.front().size();
  for (const TracePoints& points : repetitions) count = std::min(count, points.size());
  for (size_t i = 0; i < count; ++i) {
    TracePoint point;
    for (const TraceValue member : {&TracePoint::frames, &TracePoint::samples, &TracePoint::time_s, &TracePoint::mse,
                                    &TracePoint::spread, &TracePoint::display_mse}) {
      std::vector<double> values;
      for (const TracePoints& points : repetitions) values.push_back(points[i].*member);
      point.*member = median(std::move(values));
    }
    result.push_back(point);
  }
  return result;
}

namespace {

/// y at x, interpolated linearly in logarithms; clamped to the end points.
double interpolate(const TracePoints& points, TraceValue of_x, TraceValue of_y, double x) {
  if (points.empty()) return 0;
  if (x <= points.front().*of_x) return points.front().*of_y;
  for (size_t i = 1; i < points.size(); ++i) {
    if (x > points[i].*of_x) continue;
    const double span = std::log(points[i].*of_x / points[i - 1].*of_x);
    const double t = span > 0 ? std::log(x / points[i - 1].*of_x) / span : 1;
    return std::exp((1 - t) * std::log(std::max(points[i - 1].*of_y, 1e-30)) +
                    t * std::log(std::max(points[i].*of_y, 1e-30)));
  }
  return points.back().*of_y;
}

}  // namespace

double value_at(const TracePoints& points, TraceValue value, double time_s) {
  return interpolate(points, &TracePoint::time_s, value, time_s);
}

double time_of_frames(const TracePoints& points, double frames) {
  return interpolate(points, &TracePoint::frames, &TracePoint::time_s, frames);
}

double mean_ratio(const TracePoints& a, const TracePoints& b, TraceValue value, double begin_s, double end_s) {
  constexpr int kTimes = 16;
  double sum = 0;
  for (int i = 0; i < kTimes; ++i) {
    const double time_s = begin_s * std::pow(end_s / begin_s, i / (kTimes - 1.0));
    sum += std::log(std::max(value_at(a, value, time_s), 1e-30) / std::max(value_at(b, value, time_s), 1e-30));
  }
  return std::exp(sum / kTimes);
}

Ratio mean_ratio(const std::vector<Trace>& traces, size_t a, size_t b, TraceValue value, double begin, double end) {
  std::vector<double> ratios;
  for (size_t r = 0; r < traces.front().repetitions.size(); ++r) {
    const TracePoints& clock = traces.front().repetitions[r];
    const TracePoints& of_a = traces[a].repetitions[r];
    const TracePoints& of_b = traces[b].repetitions[r];
    const double begin_s = std::max({time_of_frames(clock, begin), of_a.front().time_s, of_b.front().time_s});
    ratios.push_back(mean_ratio(of_a, of_b, value, begin_s, std::max(begin_s, time_of_frames(clock, end))));
  }
  return geometric_mean(ratios);
}

Ratio early_ratio(const std::vector<Trace>& traces, size_t a, size_t b, double frames) {
  return mean_ratio(traces, a, b, &TracePoint::mse, 1, frames);
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

ImageSet trace_images(const std::string& label, const std::vector<Trace>& traces, const Image& reference) {
  std::vector<MeasuredImage> images;
  for (size_t i = 0; i < traces.size(); ++i) {
    const Trace& t = traces[i];
    images.push_back({t.name, static_cast<int>(i), &t.image,
                      fmt::format("{:.0f} ms, {:.3g} samples, MSE {:.2e}", 1000 * t.image_point.time_s,
                                  t.image_point.samples, t.image_point.mse)});
  }
  ImageSet set = measured_set(label, reference, images, {.values = false});
  for (size_t i = 0; i < traces.size(); ++i) {
    if (traces[i].map.empty()) continue;
    set.images.push_back(
        map_image(traces[i].name + ", map", static_cast<int>(i), traces[i].map, reference.width, reference.height));
  }
  return set;
}

ViewerBlock trace_viewer(std::string title, std::string text, std::vector<ImageSet> sets) {
  return {std::move(title), std::move(text), image_layer_kinds(), std::move(sets)};
}

}  // namespace relume
