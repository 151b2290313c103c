// Measures error against time for several techniques that render alternately.
#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "compare/timed_session.h"
#include "experiments/experiment.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// Measurement after a frame.
struct TracePoint {
  double frames = 0;
  double samples = 0;  ///< per pixel
  double time_s = 0;
  double mse = 0;
  double spread = 0;       ///< distance_spread()
  double display_mse = 0;  ///< display_error()
};

using TracePoints = std::vector<TracePoint>;

struct Trace {
  std::string name;
  std::vector<TracePoints> repetitions;  ///< one per repetition
  TracePoints points = {};               ///< medians over the repetitions, up to the shortest
  Image image = {};                      ///< first repetition; empty: not requested
  TracePoint image_point = {};           ///< point at which the image was taken
  std::vector<float> map = {};           ///< contender's map at the end of the first repetition
};

/// Variance over the pixels of the Euclidean distance to the reference's colour, both clamped to 1 as on a display: the
/// measure of [Schalk18 §4.2].
double distance_spread(const Image& image, const Image& reference);

/// MSE of displayed images: sRGB values, clamped to 1.
double display_error(const Image& image, const Image& reference);

/// A technique in an experiment.
struct TraceContender {
  std::string name;
  RenderSettings settings;
  int samples_per_step = 0;  ///< frames at each view before the last; 0: skips these views
  std::string map = {};      ///< buffer to display, with values in [0, 1]; empty: none
};

/// Camera motion to the last view. A step of 0 means a static camera.
struct Turn {
  float total_deg = 100;
  float step_deg = 0;
  float aside_m = 0;  ///< initial offset of the eye to the right of its last position, reduced linearly
};

struct TraceOptions {
  Turn turn = {};
  uint32_t frames = 32;  ///< frames of the first contender at the last view; the others have the same time
  int repetitions = 3;
  const Image* reference = nullptr;
  double reference_mse = 0;  ///< noise of the reference, subtracted from every MSE
  uint32_t image_frame = 0;  ///< frame of the first contender at which images are taken; 0: never
  FrameClock clock = {};     ///< empty: wall_clock()
};

/// Measures all contenders, which take turns frame by frame at the last view. Points are taken after 1, 2, 3, 4, 6, 8,
/// … frames and after the last. The first rank measures. Results of an interrupted run are read from the context's
/// parts folder.
std::vector<Trace> trace(const ExperimentContext& context, const std::string& stage, const ExperimentScene& scene,
                         const std::vector<TraceContender>& contenders, const TraceOptions& options);

constexpr auto members_of(const Trace*) {
  return std::tuple(&Trace::name, &Trace::repetitions, &Trace::points, &Trace::image, &Trace::image_point, &Trace::map);
}

using TraceValue = double TracePoint::*;

/// Median points over the repetitions, as in `Trace::points`.
TracePoints median_points(const std::vector<TracePoints>& repetitions);

/// Value at a time, interpolated linearly in logarithms; clamped to the end points.
double value_at(const TracePoints& points, TraceValue value, double time_s);

/// Time after a number of frames, interpolated the same way.
double time_of_frames(const TracePoints& points, double frames);

/// Geometric mean of a's value over b's at 16 equal times from `begin_s` to `end_s`, spaced evenly in logarithms. Below
/// 1, a is better.
double mean_ratio(const TracePoints& a, const TracePoints& b, TraceValue value, double begin_s, double end_s);

/// Same for traces `a` and `b`, per repetition, between `begin` and `end` frames of the first trace. Starts after all
/// contenders' first frames.
Ratio mean_ratio(const std::vector<Trace>& traces, size_t a, size_t b, TraceValue value, double begin, double end);

/// Same for the MSE, from all contenders' first frames to frame `frames` of the first trace.
Ratio early_ratio(const std::vector<Trace>& traces, size_t a, size_t b, double frames);

/// Curves of traces against time in milliseconds and against frames.
ChartBlock trace_charts(std::string title, std::string text, const std::vector<Trace>& traces, TraceValue value,
                        const std::string& label);

/// Images of the traces after the reference, and their maps. Requires recorded images.
ImageSet trace_images(const std::string& label, const std::vector<Trace>& traces, const Image& reference);
/// Viewer of several trace_images().
ViewerBlock trace_viewer(std::string title, std::string text, std::vector<ImageSet> sets);

}  // namespace relume
