#include "ranks/frame_dealer.h"

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

TEST(FrameDealer, DealsEachFrameOnce) {
  FrameDealer dealer(2, 20, 3, 4);
  size_t expected = 2;
  for (int turn = 0; expected < 20; ++turn) {
    const int rank = turn % 3;
    dealer.finished(rank);
    const auto segment = dealer.next(rank);
    ASSERT_TRUE(segment);
    EXPECT_EQ(segment->first, expected);
    EXPECT_LE(segment->count, 4u);
    for (size_t i = 0; i < segment->count; ++i) EXPECT_TRUE(dealer.received(segment->first + i));
    expected += segment->count;
  }
  EXPECT_TRUE(dealer.complete());
}

TEST(FrameDealer, DealsTheFramesOfASlowRankAgain) {
  FrameDealer dealer(0, 2, 2, 8);
  EXPECT_EQ(dealer.next(0)->first, 0u);
  EXPECT_EQ(dealer.next(1)->first, 1u);
  EXPECT_TRUE(dealer.received(1));
  dealer.finished(1);
  EXPECT_EQ(dealer.next(1)->first, 0u);
  EXPECT_TRUE(dealer.received(0));
  EXPECT_FALSE(dealer.received(0));
  EXPECT_TRUE(dealer.complete());
}

TEST(FrameDealer, BoundsTheImagesThatWait) {
  FrameDealer dealer(0, 100, 2, 3);
  size_t dealt = dealer.next(0)->count;  // never finished
  while (const auto segment = dealer.next(1)) {
    for (size_t i = 0; i < segment->count; ++i) dealer.received(segment->first + i);
    dealer.finished(1);
    dealt += segment->count;
  }
  EXPECT_LE(dealt, 15u);
}

}  // namespace
}  // namespace relume::ranks
