#include "core/activity.h"

#include <gtest/gtest.h>

#include "core/parallel.h"

namespace relume {
namespace {

TEST(Activity, LatestActivityIsCurrent) {
  EXPECT_FALSE(current_activity());
  {
    const Activity outer("loading a.glb");
    EXPECT_EQ(current_activity(), "loading a.glb");
    {
      const Activity inner("decoding textures", 3);
      EXPECT_EQ(current_activity(), "decoding textures, 0 of 3");
    }
    EXPECT_EQ(current_activity(), "loading a.glb");
  }
  EXPECT_FALSE(current_activity());
}

TEST(Activity, PartsCountOnAllThreads) {
  Activity activity("baking", 1000);
  parallel_for(1000, [&](size_t) { activity.part_done(); });
  EXPECT_EQ(current_activity(), "baking, 1000 of 1000");
}

}  // namespace
}  // namespace relume
