// Interruption of long preparation by the rendering thread.
#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <future>
#include <thread>

#include "viewer/render/render_thread.h"
#include "viewer/testing/render_stage.h"

namespace relume::viewer {
namespace {

using testing::Stage;

/// Selects settings whose first frame needs far more preparation than the tests wait for. Each part of 4,096 rays of a
/// cell is a task, and a stopped launch still visits all of its tasks. More rays would only add tasks.
void prepare_long(Stage& stage) {
  stage.resolution_policy.preparation_s = 0;
  stage.settings[0].render.lights = LightSelectionChoice::static_lists;
  stage.settings[0].render.static_lists.rays = 1 << 15;
  stage.settings[0].render.static_lists.cell_size = 0.04f;
}

/// Processor time, since other programs may delay this one; full preparation takes longer on any machine.
constexpr double kSoon_s = 20;
double processor_time_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(Preparation, AFrameComesBeforeLongPreparationEnds) {
  Stage stage;
  prepare_long(stage);
  stage.resolution_policy.preparation_s = 0.1f;
  const double start_s = processor_time_s();
  stage.post();
  ASSERT_TRUE(stage.next());
  EXPECT_LT(processor_time_s() - start_s, kSoon_s);
  std::promise<bool> prepared;
  stage.thread.post_task([&](const Session& session, const LoadedScene&) { prepared.set_value(session.prepared()); });
  EXPECT_FALSE(prepared.get_future().get()) << "preparation takes no time";
}

TEST(Preparation, AChangeDoesNotWaitForPreparation) {
  Stage stage;
  prepare_long(stage);
  stage.post();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(stage.thread.frame(0)) << "preparation takes no time";
  stage.settings[0].render.lights = LightSelectionChoice::power;
  const double start_s = processor_time_s();
  stage.post();
  EXPECT_TRUE(stage.next());
  EXPECT_LT(processor_time_s() - start_s, kSoon_s);
}

TEST(Preparation, TheEndDoesNotWaitForPreparation) {
  for (const bool with_task : {false, true}) {
    Stage stage;
    prepare_long(stage);
    stage.post();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_FALSE(stage.thread.frame(0)) << "preparation takes no time";
    bool done = false;
    if (with_task) stage.thread.post_task([&](const Session&, const LoadedScene&) { done = true; });
    const double start_s = processor_time_s();
    stage.thread.stop();
    EXPECT_LT(processor_time_s() - start_s, kSoon_s);
    EXPECT_EQ(done, with_task);
  }
}

}  // namespace
}  // namespace relume::viewer
