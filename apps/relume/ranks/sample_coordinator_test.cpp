#include "ranks/sample_coordinator.h"

#include <optional>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>

namespace relume::ranks {
namespace {

constexpr int kSide = 4;

/// A job whose only worker is the test.
class SampleCoordination : public testing::Test {
 protected:
  SampleCoordination() : coordinator_(link_, job()) {
    thread_ =
        std::jthread([this](const std::stop_token& stop) { coordinator_.run(stop, [](const RanksProgress&) {}); });
    link_.send(0, MessageKind::hello, hello_message("scene"));
  }

  static SampleJob job() {
    SampleJob job;
    job.image.width = job.image.height = kSide;
    job.image.window = {0, 0, kSide, kSide};
    job.limits.samples = 16 * kBlockSamples;
    job.identity = "scene";
    return job;
  }

  SampleWork next_deal() {
    const std::optional<Message> message = link_.receive_at_worker(5);
    EXPECT_TRUE(message && message->kind == MessageKind::deal);
    return message && message->kind == MessageKind::deal ? MessageReader(message->content).get<SampleWork>()
                                                         : SampleWork{};
  }

  void send_rendered(const SampleWork& work) {
    WorkProgress progress;
    progress.id = work.id;
    progress.samples = work.count;
    link_.send(0, MessageKind::rendered, MessageWriter().put(progress).take());
  }

  void send_samples(const SampleWork& work) {
    SampleResult result;
    result.id = work.id;
    result.first = work.first;
    result.blocks = work.count;
    result.seconds = 1;
    const Bytes sums(size_t{kSide} * kSide * message_bytes(false));
    link_.send(0, MessageKind::samples, MessageWriter().put(result).put_bytes(sums).take());
  }

  RankLink link_;
  SampleCoordinator coordinator_;
  std::jthread thread_;
};

TEST_F(SampleCoordination, DealsWhileOneResultWaits) {
  const SampleWork first = next_deal();
  EXPECT_FALSE(link_.receive_at_worker(0.3)) << "the rank renders";
  send_rendered(first);
  const SampleWork second = next_deal();
  EXPECT_NE(second.first, first.first);
  send_rendered(second);
  EXPECT_FALSE(link_.receive_at_worker(0.3)) << "two results would wait";
  send_samples(first);
  const SampleWork third = next_deal();
  send_samples(second);
  send_samples(third);
  send_rendered(third);  // it may come late
  const SampleWork fourth = next_deal();
  EXPECT_EQ(fourth.first, 12 * kBlockSamples);
  send_samples(fourth);
  const std::optional<Message> end = link_.receive_at_worker(5);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, MessageKind::finish);
  thread_.join();
  EXPECT_EQ(coordinator_.samples(), 16 * kBlockSamples);
}

}  // namespace
}  // namespace relume::ranks
