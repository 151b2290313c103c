// Which launches a device may keep, to begin several together.
#include <gtest/gtest.h>

#include <stop_token>
#include <string>

#include "frame/device_queue.h"
#include "frame/launch.h"
#include "frame/testing/recording_device.h"

namespace relume {
namespace {

using testing::RecordingDevice;

struct ElementKernel {
  uint32_t unused = 0;
  RELUME_HD void operator()(uint32_t, uint32_t) const {}
};

class ShortLaunchTest : public ::testing::Test {
 protected:
  /// Whether each of the launches may wait.
  std::string marks() const {
    std::string marks;
    for (const RecordingDevice::Recorded& launch : device_.launches) marks += launch.may_wait ? 'w' : '-';
    return marks;
  }
  void launch_and_finish(uint32_t elements) {
    launch(backend_, "elements", ElementKernel{}, elements, 1);
    backend_.execute([] {});
    device_.launches.clear();
  }

  RecordingDevice device_;
  Backend backend_{device_, 2};
  std::stop_source stop_;
};

TEST_F(ShortLaunchTest, MayWaitOnceItsTimeIsKnown) {
  device_.element_s = 1e-6;
  launch(backend_, "elements", ElementKernel{}, 1000, 1);
  launch(backend_, "elements", ElementKernel{}, 1000, 1);
  EXPECT_EQ(marks(), "--") << "the time is unknown";
  launch_and_finish(1000);
  for (int i = 0; i < 3; ++i) launch(backend_, "elements", ElementKernel{}, 1000, 1, stop_.get_token());
  EXPECT_EQ(marks(), "www");
}

TEST_F(ShortLaunchTest, WaitsForABandsTimeAtMost) {
  device_.element_s = 1e-6;
  launch_and_finish(1000);
  for (int i = 0; i < 13; ++i) launch(backend_, "elements", ElementKernel{}, 1900, 1);
  EXPECT_EQ(marks(), "wwwww-wwwww-w") << "1.9 ms each, at most 10 ms together";
  backend_.execute([] {});
  device_.launches.clear();
  for (int i = 0; i < 5; ++i) launch(backend_, "elements", ElementKernel{}, 1900, 1);
  EXPECT_EQ(marks(), "wwwww") << "none waits after host code";
}

TEST_F(ShortLaunchTest, DoesNotWaitIfItIsLong) {
  device_.element_s = 1e-6;
  launch_and_finish(1000);
  for (const uint32_t elements : {1000u, 3000u, 1000u}) launch(backend_, "elements", ElementKernel{}, elements, 1);
  EXPECT_EQ(marks(), "w-w");
}

TEST_F(ShortLaunchTest, WaitsWithinTheBoundOfTheQueue) {
  device_.element_s = 1e-6;
  for (int i = 0; i < 10; ++i) launch(backend_, "bands", ElementKernel{}, 1000, 1, stop_.get_token());
  for (int i = 0; i < 200; ++i) launch(backend_, "bands", ElementKernel{}, 1000, 1, stop_.get_token());
  EXPECT_LT(device_.longest_queue_s, 0.030);
}

}  // namespace
}  // namespace relume
