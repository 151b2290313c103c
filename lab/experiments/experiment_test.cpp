#include "experiments/experiment.h"

#include <filesystem>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

TEST(Experiments, AreFoundByName) {
  EXPECT_EQ(require_experiment("reprojection").name, "reprojection");
  try {
    require_experiment("reprojektion");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("did you mean 'reprojection'"), std::string::npos);
  }
}

TEST(Experiments, NamesAreUniqueWithPaperAndSummary) {
  std::set<std::string_view> names;
  for (const Experiment& experiment : experiments()) {
    EXPECT_TRUE(names.insert(experiment.name).second) << experiment.name;
    EXPECT_EQ(experiment.paper.front(), '[') << experiment.name;
    EXPECT_FALSE(experiment.summary.empty()) << experiment.name;
    EXPECT_TRUE(experiment.run);
  }
}

TEST(Experiments, StopRequestsEndThem) {
  std::stop_source stop;
  stop.request_stop();
  ExperimentContext context;
  context.quick = true;
  context.cache_folder = std::filesystem::temp_directory_path() / "relume_experiment_test";
  context.stop = stop.get_token();
  EXPECT_THROW(require_experiment("combination").run(context), ExperimentStopped);
  std::filesystem::remove_all(context.cache_folder);
}

}  // namespace
}  // namespace relume
