#include "experiments/measure/trace.h"

#include <cmath>

#include <gtest/gtest.h>

#include "experiments/measure/trace_file.h"
#include "experiments/setup/references.h"
#include "files/atomic_file.h"

namespace relume {
namespace {

/// value = factor · time^-1, with ten points per decade.
TracePoints hyperbola(double factor) {
  TracePoints points;
  for (int i = 0; i <= 20; ++i) {
    const double time_s = 0.01 * std::pow(10, 0.1 * i);
    points.push_back({double(i + 1), double(i + 1), time_s, factor / time_s, 0});
  }
  return points;
}

TEST(Trace, ValuesBetweenPointsLieOnTheLogarithmicLine) {
  const TracePoints trace = hyperbola(2);
  EXPECT_NEAR(value_at(trace, &TracePoint::mse, 0.0345), 2 / 0.0345, 1e-9 * 2 / 0.0345);
  EXPECT_DOUBLE_EQ(value_at(trace, &TracePoint::mse, 0.001), 200);  // the first point
  EXPECT_NEAR(value_at(trace, &TracePoint::mse, 9), 2, 1e-12);      // the last
}

TEST(Trace, RatiosAreGeometricMeans) {
  EXPECT_NEAR(mean_ratio(hyperbola(1), hyperbola(4), &TracePoint::mse, 0.02, 0.8), 0.25, 1e-12);
}

TEST(Trace, TimesOfFramesLieBetweenPoints) {
  EXPECT_DOUBLE_EQ(time_of_frames(hyperbola(1), 11), 0.1);
  EXPECT_NEAR(time_of_frames(hyperbola(1), std::sqrt(11.0 * 12)), 0.01 * std::pow(10, 1.05), 1e-9);
}

TEST(Trace, EarlyRatiosEndWithTheFramesOfTheFirst) {
  TracePoints late = hyperbola(3);
  for (size_t i = 8; i < late.size(); ++i) late[i].mse *= 100;
  const std::vector<Trace> traces{{"a", {hyperbola(1)}}, {"b", {late}}, {"c", {hyperbola(1)}}};
  EXPECT_NEAR(early_ratio(traces, 1, 2, 8).value, 3, 1e-9);
  EXPECT_GT(early_ratio(traces, 1, 0, 8.5).value, 3.1);
  EXPECT_GT(early_ratio(traces, 1, 2, 9).value, 3.1);
  EXPECT_EQ(early_ratio(traces, 1, 2, 21).value, early_ratio(traces, 1, 2, 1000).value);  // no further points
  EXPECT_GT(mean_ratio(traces, 1, 2, &TracePoint::mse, 10, 20).value, 299);
}

TEST(Trace, RepetitionsGiveTheIntervalOfARatio) {
  const std::vector<Trace> traces{{"a", {hyperbola(1), hyperbola(1), hyperbola(2)}},
                                  {"b", {hyperbola(2), hyperbola(4), hyperbola(4)}}};
  const Ratio ratio = early_ratio(traces, 1, 0, 8);
  EXPECT_NEAR(ratio.value, std::cbrt(2.0 * 4 * 2), 1e-9);
  EXPECT_LT(ratio.interval.low, 1);
  EXPECT_EQ(ratio.interval.confidence, 0.95);
}

TEST(Trace, SpreadIsTheVarianceOfDistances) {
  Image reference(2, 1);
  Image image(2, 1);
  image.at(0, 0) = Rgb(0.3f, 0.4f, 0.0f);  // at distance 0.5; the other one at 0
  EXPECT_NEAR(distance_spread(image, reference), 0.0625, 1e-7);
  image.at(0, 0) = Rgb(50, 0, 0);  // displayed as 1
  EXPECT_NEAR(distance_spread(image, reference), 0.25, 1e-7);
}

TEST(Trace, DisplayErrorUsesClippedSrgbValues) {
  Image reference(2, 1);
  Image image(2, 1);
  image.at(0, 0) = Rgb(0.5f, 0, 0);
  const double shown = 1.055 * std::pow(0.5, 1 / 2.4) - 0.055;
  EXPECT_NEAR(display_error(image, reference), shown * shown / 6, 1e-6);
  image.at(0, 0) = Rgb(50, 0, 0);  // displayed as 1
  EXPECT_NEAR(display_error(image, reference), 1.0 / 6, 1e-6);
}

/// Measures the box twice, as an interrupted experiment does.
TEST(Trace, ContinuesFromStoredMeasurements) {
  ExperimentContext context;
  context.quick = true;
  context.parts_folder = std::filesystem::temp_directory_path() / "relume_trace_test";
  std::filesystem::remove_all(context.parts_folder);
  const ExperimentScene box = closed_box();
  TraceContender contender{.name = "a", .settings = box.settings};
  set_size_and_device(context, contender.settings);
  contender.settings.allocation = AllocationChoice::adaptive;
  contender.map = "sampling-probability";
  const Image reference(contender.settings.width, contender.settings.height);
  TraceOptions options{.frames = 4, .repetitions = 1, .reference = &reference, .image_frame = 2};
  const auto first = trace(context, "test", box, {contender}, options);
  const auto again = trace(context, "test", box, {contender}, options);
  ASSERT_EQ(again.size(), 1u);
  ASSERT_EQ(again[0].points.size(), first[0].points.size());
  EXPECT_EQ(again[0].points.back().time_s, first[0].points.back().time_s);  // reused
  EXPECT_EQ(again[0].repetitions[0].size(), first[0].repetitions[0].size());
  EXPECT_EQ(again[0].image.pixels, first[0].image.pixels);
  EXPECT_EQ(again[0].image_point.mse, first[0].image_point.mse);
  EXPECT_EQ(again[0].map, first[0].map);
  // Changed conditions require a new measurement.
  context.program = "another";
  EXPECT_FALSE(load_traces(trace_file(context, box, {contender}, options)));
  context.program.clear();
  options.frames = 5;
  EXPECT_FALSE(load_traces(trace_file(context, box, {contender}, options)));
  options.frames = 4;
  write_file(trace_file(context, box, {contender}, options), "something else");
  EXPECT_FALSE(load_traces(trace_file(context, box, {contender}, options)));
  std::filesystem::remove_all(context.parts_folder);
}

/// Each contender runs for the same time as the first.
TEST(Trace, ContendersHaveEqualTimes) {
  ExperimentContext context;
  context.quick = true;
  const ExperimentScene box = closed_box();
  std::vector<TraceContender> contenders{{"a", box.settings, 0}, {"b", box.settings, 2}};
  for (TraceContender& c : contenders) set_size_and_device(context, c.settings);
  contenders[0].settings.path.max_bounces = 6;
  contenders[1].settings.path.max_bounces = 1;
  contenders[1].settings.history = HistoryChoice::reproject;
  const Image reference(contenders[0].settings.width, contenders[0].settings.height);
  const auto traces =
      trace(context, "test", box, contenders,
            {.turn = {100, 50}, .frames = 16, .repetitions = 1, .reference = &reference, .clock = [](const Session& s) {
               return 1e-6 * static_cast<double>(s.statistics().rays);
             }});
  ASSERT_EQ(traces.size(), 2u);
  EXPECT_EQ(traces[0].points.back().frames, 16);
  EXPECT_EQ(traces[1].points.front().frames, 1);
  // The last point is within a frame of the end, independently of the grid.
  EXPECT_GE(traces[1].repetitions[0].back().time_s, traces[0].repetitions[0].back().time_s);
}

}  // namespace
}  // namespace relume
