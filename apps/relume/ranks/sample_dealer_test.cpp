#include "ranks/sample_dealer.h"

#include <vector>

#include <gtest/gtest.h>

#include "framebuffer/pixel_sums.h"

namespace relume::ranks {
namespace {

/// Simulates ranks with these seconds per sample. Returns the time at which the last sample is done.
double simulate(SampleDealer& dealer, const std::vector<double>& sample_s, std::vector<uint32_t>& rendered) {
  struct Work {
    std::optional<Deal> deal;
    double end_s = 0;
    double start_s = 0;
  };
  std::vector<Work> ranks(sample_s.size());
  rendered.assign(sample_s.size(), 0);
  double now_s = 0;
  const auto deal_to = [&](size_t rank) {
    ranks[rank] = {dealer.next(static_cast<int>(rank), now_s), 0, now_s};
    if (ranks[rank].deal) ranks[rank].end_s = now_s + sample_s[rank] * ranks[rank].deal->count;
  };
  while (!dealer.complete()) {
    for (size_t rank = 0; rank < ranks.size(); ++rank) {
      if (!ranks[rank].deal) deal_to(rank);
    }
    size_t first = ranks.size();
    for (size_t rank = 0; rank < ranks.size(); ++rank) {
      if (ranks[rank].deal && (first == ranks.size() || ranks[rank].end_s < ranks[first].end_s)) first = rank;
    }
    if (first == ranks.size()) return -1;
    now_s = ranks[first].end_s;
    const Deal deal = *ranks[first].deal;
    ranks[first].deal.reset();
    if (dealer.finished(static_cast<int>(first), deal.id, deal.count, now_s - ranks[first].start_s))
      rendered[first] += deal.count;
    for (const int late : dealer.take_late(deal.id)) ranks[static_cast<size_t>(late)].deal.reset();
  }
  return now_s;
}

TEST(SampleDealer, DealsEachSampleOnce) {
  for (const int ranks : {1, 2, 5}) {
    SampleDealer dealer({.samples = 250, .ranks = ranks});
    std::vector<uint32_t> rendered;
    simulate(dealer, std::vector<double>(static_cast<size_t>(ranks), 0.01), rendered);
    EXPECT_EQ(dealer.done().to_string(), "0-249");
    uint32_t sum = 0;
    for (const uint32_t samples : rendered) sum += samples;
    EXPECT_EQ(sum, 250u);
  }
}

TEST(SampleDealer, KeepsFastAndSlowRanksBusy) {
  SampleDealer dealer({.samples = 4096, .ranks = 3, .target_s = 2});
  const std::vector<double> sample_s = {0.01, 0.02, 0.08};
  std::vector<uint32_t> rendered;
  const double end_s = simulate(dealer, sample_s, rendered);
  const double ideal_s = 4096 / (1 / 0.01 + 1 / 0.02 + 1 / 0.08);
  EXPECT_LT(end_s, ideal_s * 1.05);
  EXPECT_GT(rendered[0], 2 * rendered[2]);
}

TEST(SampleDealer, TwoEqualRanksEndTogether) {
  // As many samples as a small image has, with deals of the default duration and results that cost no time.
  SampleDealer dealer({.samples = 256, .ranks = 2, .target_s = 10});
  std::vector<uint32_t> rendered;
  const double end_s = simulate(dealer, {0.47, 0.45}, rendered);
  EXPECT_LT(end_s, 1.02 * 256 / (1 / 0.47 + 1 / 0.45));
}

TEST(SampleDealer, LastDealsGrowWithTheTimeOfResults) {
  // Four blocks are left, each of which takes a second.
  const auto last_of = [](int ranks, double add_s) {
    SampleDealer dealer({.samples = 8 * kBlockSamples, .ranks = ranks, .target_s = 10});
    const Deal first = *dealer.next(0, 0);
    dealer.added(add_s);
    dealer.finished(0, first.id, first.count, 4.0);
    return dealer.next(0, 1)->count;
  };
  EXPECT_EQ(last_of(2, 0.01), kBlockSamples);
  EXPECT_EQ(last_of(2, 0.9), 2 * kBlockSamples);
  EXPECT_EQ(last_of(64, 0.9), 4 * kBlockSamples);
}

TEST(SampleDealer, DealsTheLastBlocksOfASlowRankAgain) {
  SampleDealer dealer({.samples = 64, .ranks = 2});
  std::vector<uint32_t> rendered;
  const double end_s = simulate(dealer, {0.01, 100}, rendered);
  EXPECT_LT(end_s, 2);
  EXPECT_EQ(rendered[1], 0u);
  EXPECT_EQ(dealer.done().to_string(), "0-63");
}

TEST(SampleDealer, DoesNotDealARenderedDealAgain) {
  SampleDealer dealer({.samples = 8 * kBlockSamples, .ranks = 2});
  const Deal fast = *dealer.next(0, 0);
  const Deal slow = *dealer.next(1, 0);
  EXPECT_TRUE(dealer.finished(0, fast.id, fast.count, 0.1));
  SampleDealer other = dealer;
  EXPECT_EQ(other.next(0, 100)->id, slow.id);
  dealer.rendered(slow.id);
  EXPECT_FALSE(dealer.next(0, 100));
  EXPECT_TRUE(dealer.finished(1, slow.id, slow.count, 100));
  EXPECT_TRUE(dealer.complete());
}

TEST(SampleDealer, FillsTheGapsOfACheckpoint) {
  constexpr uint32_t kBlock = kBlockSamples;
  SampleRanges done({0, kBlock - 1});
  done.add(SampleRanges({2 * kBlock, 4 * kBlock - 1}));
  SampleDealer dealer({.samples = 6 * kBlock, .ranks = 2, .done = done});
  EXPECT_EQ(dealer.next(0, 0)->first, kBlock);
  const Deal second = *dealer.next(1, 0);
  EXPECT_EQ(second.first, 4 * kBlock);
  EXPECT_EQ(second.count, 2 * kBlock);
}

TEST(SampleDealer, DealsTheRestOfAnEndedDealAgain) {
  SampleDealer dealer({.samples = 48, .ranks = 1});
  const Deal deal = *dealer.next(0, 0);
  EXPECT_TRUE(dealer.finished(0, deal.id, 0, 1));
  EXPECT_EQ(dealer.next(0, 1)->first, deal.first);
}

TEST(SampleDealer, GivesReplicasTheirOwnIndices) {
  SampleDealer dealer({.samples = 100, .ranks = 2, .adapt = true});
  const Deal a = *dealer.next(0, 0);
  const Deal b = *dealer.next(1, 0);
  EXPECT_NE(a.first, b.first);
  EXPECT_TRUE(dealer.finished(0, a.id, a.count, 0.1));
  EXPECT_EQ(dealer.next(0, 1)->first, a.first + a.count);
  std::vector<uint32_t> rendered;
  SampleDealer whole({.samples = 100, .ranks = 2, .adapt = true});
  simulate(whole, {0.01, 0.03}, rendered);
  EXPECT_EQ(whole.done().count(), 100u);
}

}  // namespace
}  // namespace relume::ranks
