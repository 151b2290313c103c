#include "ranks/receive_budget.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

TEST(ReceiveBudget, HoldsItsLimitAndServesAllRanks) {
  constexpr uint64_t kLimit = 1000;
  constexpr int kRanks = 64;
  ReceiveBudget budget(kLimit);
  std::mt19937 random(1);
  std::map<int, int> granted;
  std::vector<ReceiveBudget::Reservation> reservations;
  for (int rank = 0; rank < kRanks; ++rank) budget.request(rank, 100 + random() % 300);
  for (int turn = 0; turn < 100 * kRanks; ++turn) {
    while (std::optional<ReceiveBudget::Grant> grant = budget.next()) {
      reservations.push_back(std::move(grant->reservation));
      ++granted[grant->rank];
      budget.request(grant->rank, 100 + random() % 300);
    }
    ASSERT_LE(budget.held(), kLimit);
    ASSERT_GT(budget.held(), kLimit - 400) << "the limit is not used";
    reservations.erase(reservations.begin() + static_cast<std::ptrdiff_t>(random() % reservations.size()));
  }
  ASSERT_EQ(granted.size(), static_cast<size_t>(kRanks));
  const auto [least, most] = std::minmax_element(granted.begin(), granted.end(),
                                                 [](const auto& a, const auto& b) { return a.second < b.second; });
  EXPECT_LE(most->second - least->second, 1) << "ranks take turns";
}

TEST(ReceiveBudget, GrantsALargerMessageAlone) {
  ReceiveBudget budget(100);
  budget.request(1, 60);
  budget.request(2, 500);
  budget.request(3, 10);
  std::optional<ReceiveBudget::Grant> first = budget.next();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->rank, 1);
  EXPECT_FALSE(budget.next()) << "the small message would keep the large one waiting";
  first.reset();
  std::optional<ReceiveBudget::Grant> second = budget.next();
  ASSERT_TRUE(second);
  EXPECT_EQ(second->rank, 2);
  EXPECT_FALSE(budget.next());
  second.reset();
  EXPECT_EQ(budget.held(), 0u);
  ASSERT_TRUE(budget.next());
}

TEST(ReceiveBudget, ForgetsALostRank) {
  ReceiveBudget budget(100);
  budget.request(1, 80);
  budget.request(2, 80);
  budget.request(3, 80);
  std::optional<ReceiveBudget::Grant> first = budget.next();
  ASSERT_TRUE(first);
  budget.forget(2);
  EXPECT_FALSE(budget.next());
  first.reset();
  const std::optional<ReceiveBudget::Grant> next = budget.next();
  ASSERT_TRUE(next);
  EXPECT_EQ(next->rank, 3);
}

TEST(ReceiveBudget, ReservationsMayOutliveIt) {
  std::optional<ReceiveBudget::Grant> grant;
  {
    ReceiveBudget budget(100);
    budget.request(1, 80);
    grant = budget.next();
  }
  ASSERT_TRUE(grant);
  grant.reset();
}

}  // namespace
}  // namespace relume::ranks
