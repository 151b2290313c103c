#include "ranks/link.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <thread>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "ranks/lane.h"
#include "relume/error.h"

namespace relume::ranks {
namespace {

/// Messages between ranks of this process. Each rank is the thread that called begin().
struct Network {
  std::mutex mutex;
  int size = 0;
  int begun = 0;                                                 ///< ranks
  std::map<std::tuple<int, int, int>, std::deque<Bytes>> boxes;  ///< by sender, receiver and tag
  std::map<int, uint64_t> sent;                                  ///< bytes by rank
  std::map<int, uint64_t> lost_after;                            ///< bytes after which a rank is lost
  std::set<int> lost;
  uint64_t received = 0;  ///< bytes of large messages at rank 0
  uint64_t freed = 0;     ///< of these, by the test
  uint64_t most = 0;      ///< the largest difference
};

std::unique_ptr<Network> network;
thread_local int self = 0;
int request_token = 0;

bool begin(int* rank, int* size) {
  const std::lock_guard lock(network->mutex);
  *rank = self = network->begun++;
  *size = network->size;
  return true;
}

bool send(int to, int tag, const void* bytes, int size, void** request) {
  const std::lock_guard lock(network->mutex);
  *request = &request_token;
  uint64_t& sent = network->sent[self];
  sent += static_cast<uint64_t>(size);
  const auto limit = network->lost_after.find(self);
  if (limit != network->lost_after.end() && sent > limit->second) network->lost.insert(self);
  if (network->lost.contains(self)) return true;
  const auto* const first = static_cast<const std::byte*>(bytes);
  network->boxes[{self, to, tag}].emplace_back(first, first + size);
  return true;
}

bool complete(void*, bool* done) {
  *done = true;
  return true;
}

bool find(int from, int tag, int* size, void** message) {
  const std::lock_guard lock(network->mutex);
  *message = nullptr;
  if (network->lost.contains(from)) return false;
  std::deque<Bytes>& box = network->boxes[{from, self, tag}];
  if (box.empty()) return true;
  *size = static_cast<int>(box.front().size());
  *message = std::make_unique<Bytes>(std::move(box.front())).release();
  box.pop_front();
  return true;
}

bool receive(void* message, void* target, int, void** request) {
  const std::unique_ptr<Bytes> found(static_cast<Bytes*>(message));
  std::copy(found->begin(), found->end(), static_cast<std::byte*>(target));
  *request = &request_token;
  const std::lock_guard lock(network->mutex);
  if (self != 0 || found->size() <= sizeof(Header)) return true;
  network->received += found->size();
  network->most = std::max(network->most, network->received - network->freed);
  return true;
}

bool end() { return true; }

void abort_all(int) {}

const RelumeMpi kFunctions{kRelumeMpiVersion, "memory", begin, send, complete, find, receive, end, abort_all};

class RankLinks : public testing::Test {
 protected:
  void TearDown() override {
    while (!links_.empty()) {  // rank 0 waits for all others
      links_.back()->close(1);
      links_.pop_back();
    }
  }

  void start(int ranks, uint64_t limit) {
    network = std::make_unique<Network>();
    network->size = ranks;
    for (int rank = 0; rank < ranks; ++rank) links_.push_back(std::make_unique<RankLink>(kFunctions, ""));
    first().set_receive_limit(limit);
  }

  RankLink& first() { return *links_.front(); }
  RankLink& link(int rank) { return *links_[static_cast<size_t>(rank)]; }

  /// Counts a message as no longer in memory, and frees it.
  static void drop(std::optional<Message>& message) {
    {
      const std::lock_guard lock(network->mutex);
      network->freed += message->content.size();
    }
    message.reset();
  }

  /// Waits until rank 0 has received these bytes of large messages. Returns whether it has.
  static bool wait_for_bytes(uint64_t bytes) {
    return wait_until([&] { return network->received >= bytes; });
  }
  /// Waits until a rank has sent these bytes.
  static bool wait_for_bytes_of(int rank, uint64_t bytes) {
    return wait_until([&] { return network->sent[rank] >= bytes; });
  }
  static bool wait_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 10000; ++i) {
      {
        const std::lock_guard lock(network->mutex);
        if (condition()) return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return false;
  }

  std::vector<std::unique_ptr<RankLink>> links_;
};

constexpr size_t kLarge = size_t{1} << 20;

TEST_F(RankLinks, RankZeroHoldsItsLimit) {
  constexpr int kRanks = 64;
  constexpr int kMessages = 2;
  start(kRanks, 4 * kLarge);
  for (int i = 0; i < kMessages; ++i) {
    for (int rank = 1; rank < kRanks; ++rank) link(rank).send(0, MessageKind::samples, Bytes(kLarge, std::byte(rank)));
  }
  ASSERT_TRUE(wait_for_bytes(4 * kLarge));
  std::map<int, int> messages;
  for (int i = 0; i < kMessages * (kRanks - 1); ++i) {
    std::optional<Message> message = first().receive_at_coordinator(20);
    ASSERT_TRUE(message) << "after " << i << " messages";
    EXPECT_EQ(message->content.size(), kLarge);
    EXPECT_EQ(message->content.back(), std::byte(message->from));
    ++messages[message->from];
    drop(message);
  }
  for (const auto& [rank, count] : messages) EXPECT_EQ(count, kMessages) << "rank " << rank;
  EXPECT_EQ(messages.size(), static_cast<size_t>(kRanks - 1));
  EXPECT_TRUE(link(1).wait_until_sent(5));
  EXPECT_EQ(network->most, 4 * kLarge);
}

TEST_F(RankLinks, UrgentMessagesOvertakeLargeOnes) {
  start(2, kLarge);
  link(1).send(0, MessageKind::samples, Bytes(kLarge));
  std::optional<Message> held = first().receive_at_coordinator(5);
  ASSERT_TRUE(held);
  link(1).send(0, MessageKind::samples, Bytes(kLarge));
  link(1).send(0, MessageKind::done);
  link(1).send(0, MessageKind::progress, Bytes(8));
  const std::optional<Message> urgent = first().receive_at_coordinator(5);
  ASSERT_TRUE(urgent);
  EXPECT_EQ(urgent->kind, MessageKind::progress);
  EXPECT_FALSE(first().receive_at_coordinator(0.2)) << "the limit is reached, and others keep their order";
  EXPECT_FALSE(link(1).wait_until_sent(0));
  held.reset();
  for (const MessageKind kind : {MessageKind::samples, MessageKind::done}) {
    const std::optional<Message> next = first().receive_at_coordinator(5);
    ASSERT_TRUE(next);
    EXPECT_EQ(next->kind, kind);
  }
}

TEST_F(RankLinks, UrgentMessagesCannotBeLarge) {
  start(2, kLarge);
  for (const MessageKind kind : {MessageKind::progress, MessageKind::rendered}) {
    for (RankLink* const sender : {&link(1), &first()})
      EXPECT_THROW(sender->send(0, kind, Bytes(kSmallBytes + 1)), Error) << "from rank " << sender->rank();
    link(1).send(0, kind, Bytes(kSmallBytes));
    const std::optional<Message> message = first().receive_at_coordinator(5);
    ASSERT_TRUE(message);
    EXPECT_EQ(message->kind, kind);
    EXPECT_EQ(message->content.size(), kSmallBytes);
  }
}

TEST_F(RankLinks, ALostRankReleasesItsGrant) {
  constexpr size_t kBytes = 3 * kChunkBytes;
  start(3, kBytes);
  {
    const std::lock_guard lock(network->mutex);
    network->lost_after[1] = sizeof(Header) + kChunkBytes;
  }
  link(1).send(0, MessageKind::samples, Bytes(kBytes));
  ASSERT_TRUE(wait_for_bytes_of(1, sizeof(Header)));
  link(2).send(0, MessageKind::samples, Bytes(kBytes));
  const std::optional<Message> message = first().receive_at_coordinator(10);
  ASSERT_TRUE(message);
  EXPECT_EQ(message->from, 2);
  EXPECT_EQ(first().lost_rank(), 1);
}

TEST_F(RankLinks, RefusedMessagesEndTheWait) {
  start(3, kLarge);
  link(1).send(0, MessageKind::samples, Bytes(kLarge));
  const std::optional<Message> held = first().receive_at_coordinator(5);
  ASSERT_TRUE(held);
  link(1).send(0, MessageKind::samples, Bytes(kLarge));
  link(2).send(0, MessageKind::samples, Bytes(kLarge));
  link(2).send(0, MessageKind::done);
  EXPECT_FALSE(link(2).wait_until_sent(0.1));
  first().refuse_large();
  EXPECT_TRUE(link(1).wait_until_sent(5));
  EXPECT_TRUE(link(2).wait_until_sent(5));
  const std::optional<Message> next = first().receive_at_coordinator(5);
  ASSERT_TRUE(next);
  EXPECT_EQ(next->kind, MessageKind::done);
}

TEST(RankLinkDeathTest, ARankWithoutRankZeroSaysHowToContinue) {
  const auto lose_rank_0 = [] {
    network = std::make_unique<Network>();
    network->size = 2;
    network->begun = 1;
    network->lost = {0};
    const RankLink link(kFunctions, "run what is missing again");
    std::this_thread::sleep_for(std::chrono::seconds(10));
  };
  EXPECT_EXIT(lose_rank_0(), testing::ExitedWithCode(1), "rank 1 on .* and ends; run what is missing again");
}

}  // namespace
}  // namespace relume::ranks
