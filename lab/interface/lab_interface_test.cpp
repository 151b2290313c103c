#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/lab/lab.h"

namespace relume::lab {
namespace {

ComparisonRequest small_request(const std::filesystem::path& cache) {
  return {.techniques = "default,short=max-bounces:0",
          .settings = {{"width", "24"}, {"height", "16"}},
          .spp = 4,
          .repetitions = 3,
          .reference_spp = 64,
          .cache_folder = cache};
}

TEST(LabInterface, ComparesTechniques) {
  const TempFolder folder;
  const Scene scene = find_builtin_scene("cornell")->build();
  std::vector<std::string> stages;
  const auto note = [&](const std::string& stage, double) {
    if (stages.empty() || stages.back() != stage) stages.push_back(stage);
  };
  const std::optional<ComparisonReport> report = compare(scene, small_request(folder / "cache"), {}, note);
  ASSERT_TRUE(report);
  EXPECT_EQ(stages.front(), "reference");
  ASSERT_EQ(report->contenders().size(), 2u);
  const ContenderScore& full = report->contenders()[0];
  const ContenderScore& cut = report->contenders()[1];
  EXPECT_EQ(full.name, "default");
  EXPECT_EQ(full.samples, 4);
  EXPECT_EQ(full.mses.size(), 3u);
  EXPECT_GT(cut.rel_mse, full.rel_mse) << "it lacks all light that is reflected";
  EXPECT_EQ(full.image.width, 24);
  EXPECT_GT(report->reference_mse(), 0);
  // The MSE of the report's images, which are of the first repetition.
  EXPECT_NEAR(compute_metrics(full.image, report->reference()).mse, full.mses[0], 1e-3 * full.mses[0]);
  EXPECT_NE(report->to_csv().find("short"), std::string::npos);
  EXPECT_NE(report->to_json().find("\"contenders\""), std::string::npos);
  EXPECT_NE(report->to_html().find("<html"), std::string::npos);
}

TEST(LabInterface, ComparisonsStopAndFailAsAsked) {
  const TempFolder folder;
  const Scene scene = find_builtin_scene("cornell")->build();
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(compare(scene, small_request(folder / "cache"), stop.get_token()));
  ComparisonRequest unknown = small_request(folder / "cache");
  unknown.techniques = "mystery";
  EXPECT_THROW(compare(scene, unknown), Error);
}

TEST(LabInterface, RunsExperiments) {
  const std::vector<ExperimentInfo> list = list_experiments();
  ASSERT_GT(list.size(), 10u);
  EXPECT_THROW(run_experiment("mystery", {.cache_folder = {}}), Error);
  const TempFolder folder;
  std::stop_source stop;
  stop.request_stop();
  const ExperimentRequest request{.quick = true, .cache_folder = folder / "cache"};
  EXPECT_FALSE(run_experiment(list.front().name, request, stop.get_token()));
}

}  // namespace
}  // namespace relume::lab
