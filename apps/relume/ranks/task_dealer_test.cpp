#include "ranks/task_dealer.h"

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

TEST(TaskDealer, EachRankGetsTheNextTask) {
  TaskDealer dealer(3, 2, TaskRanks::all);
  EXPECT_TRUE(dealer.deal().empty()) << "no rank waits so far";
  dealer.wait(1, "a");
  const auto first = dealer.deal();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(first[0].rank, 1);
  EXPECT_EQ(first[0].task, 0u);
  dealer.wait(0, "a");
  dealer.note_result();
  dealer.wait(1, "a");
  EXPECT_EQ(dealer.deal().size(), 2u);
  dealer.wait(0, "a");
  dealer.note_result();
  EXPECT_FALSE(dealer.is_over()) << "rank 1 works";
  dealer.note_progress(1, 0.5);
  EXPECT_NEAR(dealer.fraction(), 2.5 / 3, 1e-12);
  dealer.note_result();
  dealer.wait(1, "a");
  EXPECT_TRUE(dealer.is_over());
  EXPECT_TRUE(dealer.is_complete());
}

TEST(TaskDealer, TimedTasksGoToOneRankOfEachHost) {
  TaskDealer dealer(4, 4, TaskRanks::one_per_host);
  dealer.wait(2, "b");
  dealer.wait(1, "a");
  dealer.wait(0, "a");
  dealer.wait(3, "b");
  std::vector<int> ranks;
  for (const TaskDealer::Deal& deal : dealer.deal()) ranks.push_back(deal.rank);
  EXPECT_EQ(ranks, (std::vector<int>{1, 2}));
  EXPECT_TRUE(dealer.deal().empty()) << "both hosts are busy";
  dealer.wait(1, "a");
  const auto next = dealer.deal();
  ASSERT_EQ(next.size(), 1u);
  EXPECT_EQ(next[0].rank, 1);
  EXPECT_EQ(next[0].task, 2u);
}

TEST(TaskDealer, TimedTasksWaitUntilAllRanksHaveReported) {
  TaskDealer dealer(2, 3, TaskRanks::one_per_host);
  dealer.wait(0, "a");
  dealer.wait(1, "b");
  EXPECT_TRUE(dealer.deal().empty()) << "rank 2 may still compute";
  EXPECT_FALSE(dealer.is_over());
  dealer.leave(2);
  EXPECT_EQ(dealer.deal().size(), 2u);
}

TEST(TaskDealer, TasksOfTheFirstRankWaitForIt) {
  TaskDealer early(1, 2, TaskRanks::first);
  early.wait(0, "a");
  EXPECT_TRUE(early.deal().empty()) << "rank 1 may still compute";
  early.wait(1, "b");
  EXPECT_EQ(early.deal().size(), 1u);
  TaskDealer dealer(2, 3, TaskRanks::first);
  dealer.wait(1, "a");
  dealer.wait(2, "b");
  EXPECT_TRUE(dealer.deal().empty());
  EXPECT_FALSE(dealer.is_over());
  for (size_t task = 0; task < 2; ++task) {
    dealer.wait(0, "a");
    const auto deals = dealer.deal();
    ASSERT_EQ(deals.size(), 1u);
    EXPECT_EQ(deals[0].rank, 0);
    EXPECT_EQ(deals[0].task, task);
    dealer.note_result();
  }
  dealer.wait(0, "a");
  EXPECT_TRUE(dealer.is_over());
}

TEST(TaskDealer, ACancelledStageWaitsForWorkingRanks) {
  TaskDealer dealer(5, 3, TaskRanks::all);
  for (const int rank : {0, 1}) dealer.wait(rank, "a");
  EXPECT_EQ(dealer.deal().size(), 2u);
  dealer.leave(2);
  dealer.cancel();
  dealer.wait(0, "a");
  EXPECT_TRUE(dealer.deal().empty());
  EXPECT_FALSE(dealer.is_over());
  dealer.wait(1, "a");
  EXPECT_TRUE(dealer.is_over());
  EXPECT_FALSE(dealer.is_complete());
}

TEST(TaskDealer, AStageWithoutTasksEndsWhenAllRanksHaveReported) {
  TaskDealer dealer(0, 2, TaskRanks::all);
  dealer.wait(0, "a");
  EXPECT_FALSE(dealer.is_over());
  dealer.wait(1, "b");
  EXPECT_TRUE(dealer.is_over());
  EXPECT_TRUE(dealer.is_complete());
}

}  // namespace
}  // namespace relume::ranks
