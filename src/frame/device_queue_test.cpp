// Backends with a device, here one that records launches.
#include "frame/device_queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "frame/launch.h"
#include "frame/testing/recording_device.h"
#include "relume/error.h"

namespace relume {
namespace {

using testing::RecordingDevice;

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

/// Bands cover the window once.
void expect_cover(const std::vector<RecordingDevice::Recorded>& bands, uint32_t width, uint32_t height) {
  std::vector<int> covered(size_t{width} * height, 0);
  for (const RecordingDevice::Recorded& band : bands) {
    ASSERT_LE(band.window.x1, width);
    ASSERT_LE(band.window.y1, height);
    for (uint32_t y = band.window.y0; y < band.window.y1; ++y) {
      for (uint32_t x = band.window.x0; x < band.window.x1; ++x) ++covered[size_t{y} * width + x];
    }
  }
  EXPECT_TRUE(std::all_of(covered.begin(), covered.end(), [](int count) { return count == 1; }));
}

TEST_F(DeviceQueueTest, DividesLaunchesThatCanBeStoppedIntoBands) {
  for (const auto& [width, height] :
       {std::pair(40u, 50u), std::pair(2000u, 1u), std::pair(1u, 2000u), std::pair(700u, 3u)}) {
    device_.launches.clear();
    EXPECT_TRUE(launch_stoppable(width, height));
    EXPECT_GE(device_.launches.size(), 19u);
    EXPECT_LE(device_.launches.size(), 35u);
    expect_cover(device_.launches, width, height);
  }
  device_.launches.clear();
  launch(backend_, "whole", ElementKernel{}, 40, 50);
  EXPECT_EQ(device_.launches.size(), 1u);
}

TEST_F(DeviceQueueTest, BandsAreShortWhateverTheKernelIs) {
  device_.parallel = 800;
  device_.least_elements = 100;
  for (const double element_s : {1e-5, 5e-5, 1e-4}) {  // 1, 5, 10 ms for up to 100 elements
    device_.element_s = element_s;
    Backend backend(device_, 2);
    launch(backend, "bands", ElementKernel{}, 20000, 1, stop_.get_token());
    launch(backend, "bands", ElementKernel{}, 5000, 4, stop_.get_token());
    EXPECT_LT(device_.longest_queue_s, 0.050);
  }
}

TEST_F(DeviceQueueTest, ThreadsThatTakeLongRunSideBySide) {
  device_.parallel = 100000;
  device_.least_elements = 12500;
  device_.element_s = 1e-6;  // 12.5 ms for up to 12,500 elements
  device_.elements_of_block = {128, 1};
  launch_stoppable(2000, 1000);
  EXPECT_LE(device_.launches.size(), 200u) << "160 in bands of 12,500";
  device_.launches.clear();
  launch_stoppable(2000, 1000);
  EXPECT_LE(device_.launches.size(), 170u);
  expect_cover(device_.launches, 2000, 1000);
  EXPECT_LT(device_.longest_queue_s, 0.050);
}

TEST_F(DeviceQueueTest, ASlowFirstLaunchDoesNotDivideLaterOnes) {
  device_.parallel = 100000;
  device_.least_elements = 100000;
  device_.element_s = 4e-7;  // 40 ms, as if the driver loaded the kernel
  launch_stoppable(128, 1);
  device_.element_s = 1e-9;
  device_.launches.clear();
  launch_stoppable(2000, 1000);
  EXPECT_LE(device_.launches.size(), 160u + 20u);
}

TEST_F(DeviceQueueTest, FewBandsTestAKernelThatFillsTheDevice) {
  device_.parallel = 100000;
  device_.least_elements = 100000;
  device_.element_s = 1e-9;  // 0.1 ms for any band that does not fill it
  launch_stoppable(2000, 1000);
  EXPECT_LE(device_.launches.size(), 8u);
  expect_cover(device_.launches, 2000, 1000);
}

TEST_F(DeviceQueueTest, BandsHaveWholeBlocks) {
  constexpr uint32_t kWidth = 1001;
  constexpr uint32_t kHeight = 203;
  device_.elements_of_block = {8, 16};
  device_.element_s = 3e-6;  // bands begin with parts of rows, and go over to rows
  for (int i = 0; i < 3; ++i) {
    device_.launches.clear();
    launch_stoppable(kWidth, kHeight);
    expect_cover(device_.launches, kWidth, kHeight);
    for (const RecordingDevice::Recorded& band : device_.launches) {
      EXPECT_TRUE(band.window.width() % 8 == 0 || band.window.x1 == kWidth) << band.window.width();
      EXPECT_TRUE(band.window.height() % 16 == 0 || band.window.y1 == kHeight) << band.window.height();
    }
    device_.element_s /= 30;
  }
}

TEST_F(DeviceQueueTest, GroupsHaveNoBlocks) {
  device_.elements_of_block = {8, 16};
  launch(backend_, "groups", GroupOfThreads{}, 30, 30, stop_.get_token());
  EXPECT_EQ(device_.launches[0].window.width(), 1u) << "64 threads are more than a first band has";
  EXPECT_EQ(device_.launches[0].window.height(), 1u);
  expect_cover(device_.launches, 30, 30);
}

TEST_F(DeviceQueueTest, LaunchesOfOneKernelHaveTheirOwnTimes) {
  device_.element_s = 1e-9;
  for (int i = 0; i < 5; ++i) launch_stoppable(1000, 100);
  device_.launches.clear();
  launch(backend_, "other", ElementKernel{}, 1000, 100, stop_.get_token());
  EXPECT_EQ(device_.launches[0].window.width(), 32u);
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
  device_.fails_at = std::numeric_limits<size_t>::max();
  launch(backend_, "next", ElementKernel{}, 100, 1);
  backend_.execute([] {});
  ASSERT_EQ(backend_.times().size(), 2u) << "the launch that failed does not count";
  EXPECT_EQ(backend_.times()[1].name, "next");
  EXPECT_NEAR(backend_.times()[1].seconds, 0.01, 1e-9);
}

TEST_F(DeviceQueueTest, ForgetsLaunchesThatFailInTheQueue) {
  using Step = RecordingDevice::Step;
  for (const Step step : {Step::wait, Step::finish, Step::times}) {
    Backend backend(device_, 2);
    device_.fails_in = step;
    EXPECT_THROW(
        {
          launch(backend, "lost", ElementKernel{}, 100, 10, stop_.get_token());
          backend.execute([] {});
        },
        Error);
    EXPECT_EQ(device_.queued(), 0u);
    launch(backend, "next", ElementKernel{}, 100, 1);
    backend.execute([] {});
    for (const LaunchTime& time : backend.times()) {
      if (time.name != "next") continue;
      EXPECT_NEAR(time.seconds, 0.01, 1e-9);
    }
  }
}

TEST_F(DeviceQueueTest, ForgetsLaunchesAfterAHookThatThrows) {
  backend_.on_tile([&] {
    if (device_.launches.size() == 2) throw Error("hook");
  });
  EXPECT_THROW(launch_stoppable(100, 100), Error);
  EXPECT_EQ(device_.queued(), 0u);
}

TEST_F(DeviceQueueTest, WaitsForNestedLaunchesThatCanBeStopped) {
  backend_.run("outer", [&] {
    launch_stoppable(40, 50);
    EXPECT_EQ(device_.queued(), 0u);
  });
}

TEST_F(DeviceQueueTest, AddsTheTimesOfMoves) {
  launch(backend_, "elements", ElementKernel{}, 100, 1);
  device_.move_s = 0.5;
  backend_.execute([] {});
  ASSERT_EQ(backend_.times().size(), 2u);
  EXPECT_NEAR(backend_.times()[0].seconds, 0.01, 1e-9);
  EXPECT_EQ(backend_.times()[1].name, "moves");
  EXPECT_EQ(backend_.times()[1].seconds, 0.5);
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
