#include "ranks/sample_worker.h"

#include <chrono>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "render/testing/summing_settings.h"

namespace relume::ranks {
namespace {

/// A worker whose coordinator is the test.
class SampleWorkerTest : public ::testing::Test {
 protected:
  void deal(uint32_t id) {
    const SampleWork work{id, 0, 1, std::numeric_limits<double>::infinity()};
    link_.send(0, MessageKind::deal, MessageWriter().put(work).take());
  }
  void cancel(uint32_t id) { link_.send(0, MessageKind::cancel, MessageWriter().put(id).take()); }
  void run() {
    thread_ = std::jthread([this] { worker_.run(); });
  }
  /// The deal of the next result.
  uint32_t next_result() {
    while (const std::optional<Message> message = link_.receive_at_coordinator(20)) {
      if (message->kind == MessageKind::samples) return MessageReader(message->content).get<SampleResult>().id;
    }
    return 0;
  }
  bool forgets_cancelled_deals() const {
    for (int i = 0; i < 5000 && worker_.cancelled_deals() > 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return worker_.cancelled_deals() == 0;
  }
  void TearDown() override { link_.send(0, MessageKind::finish); }

  RankLink link_;
  Session session_{find_builtin_scene("cornell")->build(), testing::summing_settings()};
  SampleWorker worker_{session_, link_};
  std::jthread thread_;
};

TEST_F(SampleWorkerTest, SkipsDealsThatAreCancelledBeforeTheyBegin) {
  deal(1);
  cancel(1);
  deal(2);
  EXPECT_EQ(worker_.cancelled_deals(), 1u);
  run();
  EXPECT_EQ(next_result(), 2u);
  EXPECT_TRUE(forgets_cancelled_deals());
}

TEST_F(SampleWorkerTest, ForgetsDealsThatAreCancelledAfterTheirEnd) {
  deal(1);
  run();
  EXPECT_EQ(next_result(), 1u);
  cancel(1);
  deal(2);
  EXPECT_EQ(next_result(), 2u);
  EXPECT_TRUE(forgets_cancelled_deals());
}

}  // namespace
}  // namespace relume::ranks
