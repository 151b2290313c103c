#include "render/timed_stop.h"

#include <memory>

#include <gtest/gtest.h>

#include "core/clock.h"

namespace relume {
namespace {

TEST(TimedStop, ComesAfterItsTime) {
  const double start_s = now_s();
  const TimedStop timer({}, 0.05);
  while (!timer.token().stop_requested() && now_s() - start_s < 60) std::this_thread::yield();
  EXPECT_GE(now_s() - start_s, 0.05);
  EXPECT_TRUE(timer.token().stop_requested());
}

TEST(TimedStop, ComesWithTheOuterOne) {
  const auto outer = std::make_unique<std::stop_source>();
  const TimedStop timed(outer->get_token(), 1e9);
  const TimedStop untimed(outer->get_token(), 0);
  EXPECT_FALSE(timed.token().stop_requested());
  EXPECT_FALSE(untimed.token().stop_requested());
  outer->request_stop();
  EXPECT_TRUE(timed.token().stop_requested());
  EXPECT_TRUE(untimed.token().stop_requested());
}

TEST(TimedStop, IsDestroyedAtOnceWithoutStopping) {
  std::stop_token token;
  const double start_s = now_s();
  {
    const TimedStop timer({}, 1e9);
    token = timer.token();
  }
  EXPECT_LT(now_s() - start_s, 60);
  EXPECT_FALSE(token.stop_requested());
}

}  // namespace
}  // namespace relume
