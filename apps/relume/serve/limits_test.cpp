#include "serve/limits.h"

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include <gtest/gtest.h>

namespace relume::serve {
namespace {

TEST(RateLimiter, PermitsABurstAndThenTheRate) {
  RateLimiter limiter(10, 5);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(limiter.take(1, 0));
  EXPECT_FALSE(limiter.take(1, 0));
  EXPECT_NEAR(limiter.wait_s(1, 0), 0.1, 1e-9);
  EXPECT_FALSE(limiter.take(1, 0.09));
  EXPECT_TRUE(limiter.take(1, 0.1001));
  int taken = 0;
  for (int i = 0; i < 1000; ++i) taken += limiter.take(1, 1 + 0.01 * i) ? 1 : 0;
  EXPECT_NEAR(taken, 5 + 100, 1);  // ten seconds, and a full bucket before
}

TEST(RateLimiter, NeverHoldsMoreThanItsBucket) {
  RateLimiter limiter(1000, 3);
  int taken = 0;
  for (int i = 0; i < 10; ++i) taken += limiter.take(1, 1e6) ? 1 : 0;
  EXPECT_EQ(taken, 3);
  EXPECT_TRUE(std::isinf(limiter.wait_s(4, 1e6)));
  EXPECT_FALSE(limiter.take(4, 2e6));
}

TEST(ScreenshotLimit, OneAtATimeAndARate) {
  RateLimiter all(100, 100);
  ScreenshotLimit limit;
  EXPECT_FALSE(limit.end()) << "none has begun";
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(limit.begin(all, 0), "") << i;
    EXPECT_NE(limit.begin(all, 0).find("in progress"), std::string::npos);
    EXPECT_TRUE(limit.end());
  }
  EXPECT_NE(limit.begin(all, 0).find("in 2 s"), std::string::npos);
  EXPECT_FALSE(limit.end());
  EXPECT_EQ(limit.begin(all, 2.01), "");
}

TEST(ScreenshotLimit, AllViewersShareARate) {
  RateLimiter all(1, 2);
  ScreenshotLimit first;
  ScreenshotLimit second;
  ScreenshotLimit third;
  EXPECT_EQ(first.begin(all, 0), "");
  EXPECT_EQ(second.begin(all, 0), "");
  EXPECT_NE(third.begin(all, 0).find("in 1 s"), std::string::npos);
  EXPECT_EQ(third.begin(all, 1.01), "") << "the refused one does not count";
}

TEST(RateLimiter, TimeThatRunsBackwardsAddsNothing) {
  RateLimiter limiter(10, 1);
  EXPECT_TRUE(limiter.take(1, 100));
  EXPECT_FALSE(limiter.take(1, 50));
  EXPECT_FALSE(limiter.take(1, 100));
  EXPECT_TRUE(limiter.take(1, 100.2));
}

TEST(WaitingRoom, ReplacesTheOldestOfACrowdedAddress) {
  WaitingRoom room(8, 3);
  for (uint64_t i = 1; i <= 3; ++i) EXPECT_FALSE(room.enter(i, "10.0.0.1"));
  EXPECT_EQ(room.enter(4, "10.0.0.1"), std::optional<uint64_t>(1));
  EXPECT_EQ(room.enter(5, "10.0.0.1"), std::optional<uint64_t>(2));
  EXPECT_EQ(room.size(), 3u);
  EXPECT_FALSE(room.enter(6, "10.0.0.2"));
}

TEST(WaitingRoom, AFullRoomTakesFromTheLargestCrowd) {
  WaitingRoom room(6, 5);
  EXPECT_FALSE(room.enter(1, "quiet"));
  for (uint64_t i = 2; i <= 6; ++i) EXPECT_FALSE(room.enter(i, "crowd"));
  EXPECT_EQ(room.enter(7, "new"), std::optional<uint64_t>(2));
  EXPECT_EQ(room.enter(8, "another"), std::optional<uint64_t>(3));
  EXPECT_EQ(room.size(), 6u);
}

TEST(WaitingRoom, StaysBoundedUnderManyConnections) {
  WaitingRoom room;
  for (uint64_t i = 0; i < 10000; ++i) {
    room.enter(i, i % 3 == 0 ? "a" : "b" + std::to_string(i % 100));
    EXPECT_LE(room.size(), kMaxWaiting);
  }
  for (uint64_t i = 0; i < 10000; ++i) room.leave(i);
  EXPECT_EQ(room.size(), 0u);
}

}  // namespace
}  // namespace relume::serve
