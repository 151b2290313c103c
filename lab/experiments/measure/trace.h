// Error against time of several techniques, measured in turns.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "compare/timed_session.h"
#include "experiments/experiment.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/scenes.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// After a frame.
struct TracePoint {
  double frames = 0;
  double samples = 0;  ///< a pixel
  double time_s = 0;
  double mse = 0;
  double spread = 0;       ///< distance_spread()
  double display_mse = 0;  ///< display_error()
};

using TracePoints = std::vector<TracePoint>;

struct Trace {
  std::string name;
  std::vector<TracePoints> repetitions;  ///< each to the end of its time
  TracePoints points = {};               ///< medians over the repetitions, as far as all have them
  Image image = {};                      ///< of the first repetition; empty: none was asked for
  TracePoint image_point = {};           ///< after which it was taken
  std::vector<float> map = {};           ///< the contender's map at the end of the first repetition
};

/// Variance over the pixels of the Euclidean distance to the reference's colour, both cut off at 1 as a display does:
/// what [Schalk18 §4.2] measures.
double distance_spread(const Image& image, const Image& reference);

/// MSE of what a display shows of an image: of sRGB values, cut off at 1.
double display_error(const Image& image, const Image& reference);

/// A technique in an experiment.
struct TraceContender {
  std::string name;
  RenderSettings settings;
  int samples_per_step = 0;  ///< frames at each view before the last; 0: does not see them
  std::string map = {};      ///< buffer with values from 0 to 1 that is worth seeing; empty: none
};

/// How the camera gets to its last view. A step of 0: it was there all along.
struct Turn {
  float total_deg = 100;
  float step_deg = 0;
  float aside_m = 0;  ///< how far to the right of its last place the eye begins; it comes closer evenly
};

struct TraceOptions {
  Turn turn = {};
  uint32_t frames = 32;  ///< of the first contender at the last view; the others have as much time
  int repetitions = 3;
  const Image* reference = nullptr;
  double reference_mse = 0;  ///< its own noise, which is taken off every MSE
  uint32_t image_frame = 0;  ///< of the first contender, at which images are taken; 0: never
  FrameClock clock = {};     ///< empty: wall_clock()
};

/// Contenders take turns frame by frame at the last view; points are measured after 1, 2, 3, 4, 6, 8, … frames and
/// after the last. What an interrupted run of the experiment has measured is taken from the context's parts folder.
std::vector<Trace> trace(const ExperimentContext& context, const std::string& stage, const ExperimentScene& scene,
                         const std::vector<TraceContender>& contenders, const TraceOptions& options);

using TraceValue = double TracePoint::*;

/// What `Trace::points` are.
TracePoints median_points(const std::vector<TracePoints>& repetitions);

/// Value at a time, between points of a curve that is straight in logarithms; the nearest end outside of it.
double value_at(const TracePoints& points, TraceValue value, double time_s);

/// The time of so many frames, between points as above.
double time_of_frames(const TracePoints& points, double frames);

/// Geometric mean of a's value over b's at equal times, over 16 times from `begin_s` to `end_s` evenly in logarithms.
/// Below 1: a is better.
double mean_ratio(const TracePoints& a, const TracePoints& b, TraceValue value, double begin_s, double end_s);

/// The same of traces `a` and `b`, each repetition by itself, between the times of `begin` and `end` frames of the
/// first trace; not before everybody's first frame.
Ratio mean_ratio(const std::vector<Trace>& traces, size_t a, size_t b, TraceValue value, double begin, double end);

/// The same of the MSE, from everybody's first frame to the time of `frames` frames of the first trace.
Ratio early_ratio(const std::vector<Trace>& traces, size_t a, size_t b, double frames);

/// Curves of traces against time in milliseconds and against frames.
ChartBlock trace_charts(std::string title, std::string text, const std::vector<Trace>& traces, TraceValue value,
                        const std::string& label);

/// The traces' images after the reference, and their maps. Requires that images were taken.
ImageSet trace_images(const std::string& label, const std::vector<Trace>& traces, const Image& reference);
/// Sets of trace_images() to choose from.
ViewerBlock trace_viewer(std::string title, std::string text, std::vector<ImageSet> sets);

}  // namespace relume
