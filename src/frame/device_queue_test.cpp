// Backends with a device, here one that records launches and says how long they would take.
#include "frame/device_queue.h"

#include <gtest/gtest.h>

#include <deque>
#include <numeric>
#include <string>

#include "frame/launch.h"
#include "relume/error.h"

namespace relume {
namespace {

struct ElementKernel {
  uint8_t first = 1;
  uint32_t second = 2;
  RELUME_HD void operator()(uint32_t, uint32_t) const {}
};

struct GroupOfThreads {
  static constexpr uint32_t kThreads = 64;
  struct Shared {
    uint32_t sum;
  };
  template <typename Group>
  RELUME_HD void operator()(const Group&, Shared&, uint32_t, uint32_t) const {}
};

/// Ends launches when the host waits for them.
class RecordingDevice final : public Device {
 public:
  struct Recorded {
    std::string kernel;
    uint32_t threads;
    std::vector<std::byte> argument;
    Tile window;
  };

  Memory& memory() override { return host_memory(); }
  uint32_t parallel_threads() const override { return 100; }
  void launch(const DeviceLaunch& launch) override {
    if (fails_at == launches.size()) throw Error("the device is lost");
    launches.push_back({std::string(launch.kernel), launch.threads,
                        std::vector<std::byte>(launch.argument.begin(), launch.argument.end()), launch.window});
    const uint64_t elements = uint64_t{launch.window.width()} * launch.window.height();
    queued_.push_back(element_s * static_cast<double>(elements));
    longest_queue_s = std::max(longest_queue_s, std::accumulate(queued_.begin(), queued_.end(), 0.0));
  }
  void wait(size_t count) override {
    for (; queued_.size() > count; queued_.pop_front()) ended_.push_back(queued_.front());
  }
  void finish() override { wait(0); }
  std::vector<double> take_times() override { return std::exchange(ended_, {}); }
  size_t queued() const { return queued_.size(); }

  std::vector<Recorded> launches;
  double element_s = 1e-4;
  double longest_queue_s = 0;
  size_t fails_at = 1000;

 private:
  std::deque<double> queued_;
  std::vector<double> ended_;
};

class DeviceQueueTest : public ::testing::Test {
 protected:
  /// Launches a kernel that can be stopped.
  bool launch_stoppable(uint32_t width, uint32_t height) {
    return launch(backend_, "bands", ElementKernel{}, width, height, stop_.get_token());
  }

  RecordingDevice device_;
  Backend backend_{device_, 2};
  std::stop_source stop_;
};

TEST_F(DeviceQueueTest, SendsTheKernelAndItsWindow) {
  EXPECT_TRUE(launch(backend_, "elements", ElementKernel{3, 4}, Tile{1, 2, 30, 40}));
  EXPECT_TRUE(launch(backend_, "groups", GroupOfThreads{}, 5, 6));
  EXPECT_TRUE(launch(backend_, "nothing", ElementKernel{}, 0, 6));
  ASSERT_EQ(device_.launches.size(), 2u);
  EXPECT_EQ(device_.launches[0].kernel, "relume::(anonymous namespace)::ElementKernel");
  EXPECT_EQ(device_.launches[0].threads, 0u);
  EXPECT_EQ(device_.launches[0].argument.size(), sizeof(ElementKernel));
  EXPECT_EQ(device_.launches[0].argument[4], std::byte{4});
  EXPECT_EQ(device_.launches[0].window.y1, 40u);
  EXPECT_EQ(device_.launches[1].threads, 64u);
  EXPECT_EQ(device_.queued(), 2u) << "nothing waits for them";
  EXPECT_EQ(backend_.form(), KernelForm::device);
}

TEST_F(DeviceQueueTest, HostCodeWaitsForLaunches) {
  const auto queued_within = [&](const auto& run) {
    launch(backend_, "before", ElementKernel{}, 8, 8);
    size_t queued = 1;
    run([&] { queued = device_.queued(); });
    return queued;
  };
  EXPECT_EQ(queued_within([&](const auto& f) { backend_.run("host", f); }), 0u);
  EXPECT_EQ(queued_within([&](const auto& f) { backend_.run_library("library", f); }), 0u);
  EXPECT_EQ(queued_within([&](const auto& f) { backend_.execute(f); }), 0u);
  EXPECT_EQ(queued_within([&](const auto& f) {
              launch_tiles(backend_, "tiles", [&](const Tile&) { f(); }, Tile{0, 0, 1, 1}, {});
            }),
            0u);
  EXPECT_EQ(queued_within([&](const auto& f) {
              backend_.run("outer", [&] {
                launch(backend_, "inner", ElementKernel{}, 8, 8);
                f();
              });
            }),
            0u);
}

TEST_F(DeviceQueueTest, AddsTheTimesOfTheDevice) {
  launch(backend_, "elements", ElementKernel{}, 100, 1);
  launch(backend_, "elements", ElementKernel{}, 200, 1);
  EXPECT_EQ(backend_.times().at(0).seconds, 0) << "they have not ended";
  backend_.run("host", [&] { launch(backend_, "nested", ElementKernel{}, 500, 1); });
  ASSERT_EQ(backend_.times().size(), 3u);
  EXPECT_NEAR(backend_.times()[0].seconds, 0.03, 1e-9);
  EXPECT_EQ(backend_.times()[0].launches, 2u);
  EXPECT_NEAR(backend_.times()[1].seconds, 0.05, 1e-9) << backend_.times()[1].name;
  EXPECT_LT(backend_.times()[2].seconds, 0.01) << backend_.times()[2].name;
}

/// Bands cover the window once, in order.
void expect_bands(const std::vector<RecordingDevice::Recorded>& bands, const Tile& window, bool by_columns) {
  uint32_t next = by_columns ? window.x0 : window.y0;
  for (const RecordingDevice::Recorded& band : bands) {
    EXPECT_EQ(by_columns ? band.window.x0 : band.window.y0, next);
    next = by_columns ? band.window.x1 : band.window.y1;
    EXPECT_EQ(by_columns ? band.window.height() : band.window.width(), by_columns ? window.height() : window.width());
  }
  EXPECT_EQ(next, by_columns ? window.x1 : window.y1);
}

TEST_F(DeviceQueueTest, DividesLaunchesThatCanBeStoppedIntoBands) {
  for (const auto& [width, height] : {std::pair(40u, 50u), std::pair(2000u, 1u), std::pair(300u, 3u)}) {
    device_.launches.clear();
    EXPECT_TRUE(launch_stoppable(width, height));
    EXPECT_GE(device_.launches.size(), std::min(height == 1 ? width : height, 10u));
    expect_bands(device_.launches, {0, 0, width, height}, height == 1);
  }
  device_.launches.clear();
  launch(backend_, "whole", ElementKernel{}, 40, 50);
  EXPECT_EQ(device_.launches.size(), 1u);
}

TEST_F(DeviceQueueTest, BandsFollowTheTimeOfTheKernel) {
  device_.element_s = 1e-6;  // 10 ms for 10,000
  launch_stoppable(100, 10000);
  EXPECT_GT(device_.launches.size(), 90u);
  EXPECT_LT(device_.launches.size(), 120u);
  EXPECT_LT(device_.longest_queue_s, 0.030);
  device_.launches.clear();
  device_.element_s = 1e-9;
  for (int i = 0; i < 100; ++i) launch_stoppable(100, 10000);
  device_.launches.clear();
  launch_stoppable(100, 10000);
  EXPECT_EQ(device_.launches.size(), 1u);
}

TEST_F(DeviceQueueTest, StopsBetweenBands) {
  backend_.on_tile([&] {
    if (device_.launches.size() == 3) stop_.request_stop();
  });
  EXPECT_FALSE(launch_stoppable(100, 100));
  EXPECT_EQ(device_.launches.size(), 3u);
  EXPECT_FALSE(launch_stoppable(100, 100));
  EXPECT_EQ(device_.launches.size(), 3u);
}

TEST_F(DeviceQueueTest, KeepsLaunchesWhereTheThreadsChange) {
  launch(backend_, "elements", ElementKernel{}, 100, 1);
  backend_.configure(1, KernelForm::host);
  EXPECT_EQ(backend_.threads(), 1);
  EXPECT_EQ(backend_.form(), KernelForm::device);
  EXPECT_EQ(device_.queued(), 1u);
  backend_.execute([] {});
  EXPECT_NEAR(backend_.times().at(0).seconds, 0.01, 1e-9);
}

TEST_F(DeviceQueueTest, ForgetsLaunchesAfterAnError) {
  launch(backend_, "good", ElementKernel{}, 8, 8);
  device_.fails_at = 1;
  EXPECT_THROW(launch(backend_, "bad", ElementKernel{}, 8, 8), Error);
  EXPECT_EQ(device_.queued(), 0u);
  device_.fails_at = 1000;
  launch(backend_, "next", ElementKernel{}, 100, 1);
  backend_.execute([] {});
  ASSERT_EQ(backend_.times().size(), 2u) << "the launch that failed does not count";
  EXPECT_EQ(backend_.times()[1].name, "next");
  EXPECT_NEAR(backend_.times()[1].seconds, 0.01, 1e-9);
}

TEST(DeviceQueue, WaitsWhenTheBackendEnds) {
  RecordingDevice device;
  {
    Backend backend(device, 1);
    launch(backend, "last", ElementKernel{}, 8, 8);
  }
  EXPECT_EQ(device.queued(), 0u);
  EXPECT_TRUE(device.take_times().empty());
}

}  // namespace
}  // namespace relume
