#include "render/session.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(PassTimes, AreWhatHasBeenTakenSince) {
  const std::vector<PassTime> before{{"trace", 1}, {"build", 3}};
  const std::vector<PassTime> now{{"build", 3}, {"trace", 1.5}, {"bmfr-fit", 0.25}};
  const std::vector<PassTime> since = pass_times_since(now, before);
  ASSERT_EQ(since.size(), 3u);
  EXPECT_EQ(since[0].name, "build");
  EXPECT_EQ(since[0].seconds, 0);
  EXPECT_EQ(since[1].name, "trace");
  EXPECT_EQ(since[1].seconds, 0.5);
  EXPECT_EQ(since[2].name, "bmfr-fit");  // had not run before
  EXPECT_EQ(since[2].seconds, 0.25);
}

}  // namespace
}  // namespace relume
