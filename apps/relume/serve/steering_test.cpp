#include "serve/steering.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace relume::serve {
namespace {

TEST(Steering, TheFirstViewerSteersUntilItLeaves) {
  Steering steering;
  EXPECT_FALSE(steering.steers(0));
  steering.join(1, 0);
  steering.join(2, 0);
  steering.join(3, 0);
  EXPECT_TRUE(steering.steers(1));
  EXPECT_FALSE(steering.steers(2));
  steering.leave(2, 1);
  EXPECT_TRUE(steering.steers(1));
  steering.leave(1, 1);
  EXPECT_TRUE(steering.steers(3));
  steering.leave(3, 1);
  EXPECT_EQ(steering.steerer(), 0u);
  EXPECT_TRUE(steering.viewers().empty());
}

TEST(Steering, OnlyTheSteeringViewerGrants) {
  Steering steering;
  for (const uint32_t viewer : {1u, 2u, 3u}) steering.join(viewer, 0);
  steering.grant(2, 2, 0);
  EXPECT_TRUE(steering.steers(1));
  steering.grant(1, 9, 0);  // no such viewer
  EXPECT_TRUE(steering.steers(1));
  steering.grant(1, 3, 0);
  EXPECT_TRUE(steering.steers(3));
}

TEST(Steering, ARequestWaitsForAGrantOrInactivity) {
  Steering steering;
  steering.join(1, 0);
  steering.join(2, 0);
  steering.active(1, 100);
  steering.request(2, 101);
  steering.request(2, 101);
  EXPECT_EQ(steering.requests(), std::vector<uint32_t>{2});
  EXPECT_TRUE(steering.steers(1));
  steering.update(100 + Steering::kInactive_s - 0.1);
  EXPECT_TRUE(steering.steers(1));
  steering.update(100 + Steering::kInactive_s + 0.1);
  EXPECT_TRUE(steering.steers(2));
  EXPECT_TRUE(steering.requests().empty());
}

TEST(Steering, ARequestComesFirstWhenTheSteeringViewerLeaves) {
  Steering steering;
  for (const uint32_t viewer : {1u, 2u, 3u}) steering.join(viewer, 0);
  steering.request(3, 0);
  steering.request(7, 0);  // no such viewer
  steering.request(1, 0);  // it steers
  EXPECT_EQ(steering.requests(), std::vector<uint32_t>{3});
  steering.leave(1, 0);
  EXPECT_TRUE(steering.steers(3));
}

}  // namespace
}  // namespace relume::serve
