#include "experiments/measure/study.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

class StudyTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    context_.quick = true;
    context_.cache_folder = std::filesystem::temp_directory_path() / ("relume_study_" + name);
    std::filesystem::remove_all(context_.cache_folder);
  }
  void TearDown() override { std::filesystem::remove_all(context_.cache_folder); }

  ExperimentContext context_;
};

TEST_F(StudyTest, ComparesAsTheCommandDoes) {
  const Comparison c = study(context_, closed_box(),
                             {.techniques = "few=max-bounces:1,all=lights:power", .spp = 4, .reference_spp = 16});
  EXPECT_EQ(c.contenders.size(), 2u);
  EXPECT_EQ(c.reference.image.width, 32);
  EXPECT_EQ(c.reference.spp, 16);
  EXPECT_EQ(c.reference_settings.render.path.max_bounces, 6);  // from the scene's settings
  EXPECT_GT(contender_named(c, "few").repetitions[0].mse, 0);
  const ContenderResult& all = contender_named(c, "all");
  EXPECT_EQ(all.repetitions.size(), 2u);
  EXPECT_EQ(all.repetitions[0].curve.size(), 4u);  // after 1, 2, 3 and 4 frames
  const auto passes = median_pass_ms(all);
  const auto trace = std::find_if(passes.begin(), passes.end(), [](const auto& pass) { return pass.first == "trace"; });
  ASSERT_NE(trace, passes.end());
  EXPECT_GT(trace->second, 0);
  EXPECT_GT(median_of(contender_named(c, "all"), frame_ms), trace->second);
  EXPECT_THROW(contender_named(c, "other"), Error);
  const std::vector<Block> blocks = study_blocks("Box", c);
  EXPECT_EQ(std::get<ViewerBlock>(blocks.front()).title, "Box: Images");
}

TEST_F(StudyTest, LooksThroughTheCameraOfTheExperiment) {
  ExperimentScene box = closed_box();
  const StudyOptions options{.techniques = "a=max-bounces:1", .repetitions = 1, .reference_spp = 2};
  const Image ahead = study(context_, box, options).reference.image;
  box.camera = turned(box, 90);
  EXPECT_TRUE(ahead.pixels != study(context_, box, options).reference.image.pixels);
}

TEST_F(StudyTest, FollowsAnAnimation) {
  const Comparison c = study(context_, built_in("cornell-closed", 2),
                             {.techniques = "kept=history:reproject", .times_s = frame_times(3), .reference_spp = 4});
  EXPECT_EQ(contender_named(c, "kept").repetitions[0].curve.size(), 3u);
  EXPECT_GT(c.contenders[0].repetitions[0].temporal_error, 0);
  EXPECT_THROW(built_in("no such scene", 2), Error);
}

TEST_F(StudyTest, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  context_.stop = stop.get_token();
  EXPECT_THROW(study(context_, closed_box(), {.techniques = "a=max-bounces:1"}), ExperimentStopped);
}

}  // namespace
}  // namespace relume
