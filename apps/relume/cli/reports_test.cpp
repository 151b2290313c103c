#include "cli/reports.h"

#include <gtest/gtest.h>

#include <limits>

#include <fmt/format.h>

#include "cli/scene_summary.h"
#include "relume/lab/metrics.h"

namespace relume::cli {
namespace {

void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << part << " in " << text;
}

TEST(Reports, RunHasTheNamesThatScriptsRelyOn) {
  RunReport report;
  report.scene = "a \"quoted\" \xff name";
  report.rays = uint64_t{1} << 60;
  report.estimated_error = std::numeric_limits<double>::infinity();
  report.passes = {{"trace", 1.5, 0.375}, {"accumulate", 0.25}};
  report.figures = {{"cells.occupancy", 0.25}};
  const std::string text = to_json(report);
  for (const char* name : {"load_s", "build_s", "accel_s", "render_s", "samples", "paths", "nonfinite_samples",
                           "threads", "peak_memory_bytes", "scene_bytes", "buffer_bytes", "technique_bytes"}) {
    expect_in(fmt::format("\"{}\": 0", name), text);
  }
  expect_in("\"rays\": 1152921504606846976", text);
  expect_in("\"estimated_error\": null", text);
  expect_in("\"crop\": null", text);
  expect_in("\"scene\": \"a \\\"quoted\\\" \xef\xbf\xbd name\"", text);  // U+FFFD for invalid UTF-8
  expect_in("\"cells.occupancy\": 0.25", text);
  expect_in("\"name\": \"trace\",\n      \"seconds\": 1.5", text);
}

TEST(Reports, ControlCharactersAreEscaped) {
  RunReport report;
  report.scene = "a\x1b[2J\x7f\nb";
  expect_in("\"scene\": \"a\\u001b[2J\\u007f\\nb\"", to_json(report));
}

TEST(Reports, IdleSharesAreOfTheTimeOfAllThreads) {
  RunReport report;
  report.threads = 2;
  report.render_s = 4;
  // Two seconds outside the passes are on one of two threads. The build comes before render_s.
  report.passes = {{"build", 3, 2.5}, {"trace", 1.5, 0.75}, {"accumulate", 0.5, 0.25}};
  const std::string text = to_json(report);
  expect_in("\"name\": \"trace\",\n      \"seconds\": 1.5,\n      \"idle_share\": 0.25", text);
  expect_in("\n  \"idle_share\": 0.375", text);
}

TEST(Reports, RunDescribesTheGpu) {
  RunReport report;
  expect_in("\"device\": null", to_json(report));
  report.device = DeviceStatistics{"Stub GPU 0 (cuda:0)", "13.0", 4000, 3000, 2000};
  const std::string text = to_json(report);
  expect_in("\"device\": {\n    \"name\": \"Stub GPU 0 (cuda:0)\",\n    \"driver\": \"13.0\"", text);
  expect_in("\"memory_bytes\": 4000", text);
  expect_in("\"memory_limit_bytes\": 3000", text);
  expect_in("\"memory_used_bytes\": 2000", text);
}

TEST(Reports, SamplesAreWholeWhereTheyCan) {
  EXPECT_EQ(format_samples(1), "1");
  EXPECT_EQ(format_samples(1 << 20), "1048576");
  EXPECT_EQ(format_samples(12.2468), "12.25");
  RunReport report;
  report.samples_per_pixel = 64;
  expect_in("\"samples_per_pixel\": 64,", to_json(report));
}

TEST(Reports, MetricsHaveTheNamesThatScriptsRelyOn) {
  Metrics metrics;
  metrics.mse = 0.5;
  metrics.mean_a = {1, 2, 3};
  const std::string text = to_json(metrics, false);
  expect_in("\"mse\": 0.5", text);
  for (const char* name : {"rel_mse", "mae", "mape", "flip"}) expect_in(fmt::format("\"{}\": 0.0", name), text);
  expect_in("\"mean_a\": [\n    1.0,\n    2.0,\n    3.0\n  ]", text);
  expect_in("\"mean_b\"", text);
  EXPECT_EQ(text.find("hdr_flip"), std::string::npos);
  expect_in("\"hdr_flip\": 0.0", to_json(metrics, true));
}

TEST(Reports, ImagesListChannelsAndAttributes) {
  const std::string text = to_json(ImageReport{3, 2, {{"depth.Z", 0.5f, 4.0f}}, {{"relume.seed", "7"}}});
  expect_in("\"width\": 3", text);
  expect_in("\"name\": \"depth.Z\",\n      \"min\": 0.5,\n      \"max\": 4.0", text);
  expect_in("\"relume.seed\": \"7\"", text);
}

TEST(Reports, ExtremesIgnoreNan) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const ImageReport::Channel channel = report_channel({"R", {kNan, 100, kNan, 1, 2}});
  EXPECT_EQ(channel.min, 1);
  EXPECT_EQ(channel.max, 100);
  EXPECT_EQ(channel.nonfinite, 2u);
  const ImageReport::Channel lost = report_channel({"R", {kNan}});
  EXPECT_GT(lost.min, lost.max);
  expect_in("\"max\": null", to_json(ImageReport{1, 1, {lost}, {}}));
}

TEST(Reports, ScenesThatPlaceNothingHaveNoBounds) {
  SceneSummary summary;
  summary.warnings = {"a texture is missing"};
  std::string text = to_json(summary);
  expect_in("\"bounds_min\": null", text);
  expect_in("\"a texture is missing\"", text);
  summary.bounds_min = Vec3(-1, 0, 2);
  summary.bounds_max = Vec3(1, 0, 2);
  text = to_json(summary);
  expect_in("\"bounds_min\": [\n    -1.0,\n    0.0,\n    2.0\n  ]", text);
}

}  // namespace
}  // namespace relume::cli
