#include "viewer/model/monitor.h"

#include <gtest/gtest.h>

namespace relume::viewer {
namespace {

TEST(Monitor, CountsFramesOfTheInterface) {
  Monitor monitor;
  monitor.rendered_frame(0);
  for (int i = 0; i <= 120; ++i) monitor.interface_frame(i / 40.0);
  EXPECT_NEAR(monitor.interface_hz(), 40, 1e-6);
  ASSERT_TRUE(monitor.worst_interface_hz());
  EXPECT_NEAR(*monitor.worst_interface_hz(), 40, 1.5);  // a second may have one frame more or fewer
  monitor.interface_frame(3.5);
  EXPECT_NEAR(monitor.longest_gap_s(), 0.5, 1e-9);
  EXPECT_LT(*monitor.worst_interface_hz(), 25);
}

TEST(Monitor, DoesNotCountInterruptions) {
  Monitor monitor;
  monitor.rendered_frame(0);
  for (int i = 0; i <= 80; ++i) monitor.interface_frame(i / 40.0);
  monitor.interrupt();
  for (int i = 0; i <= 80; ++i) monitor.interface_frame(5 + i / 40.0);
  EXPECT_LT(monitor.longest_gap_s(), 0.1);
  EXPECT_GT(*monitor.worst_interface_hz(), 38);
}

TEST(Monitor, IgnoresTheInterfaceBeforeTheFirstFrame) {
  Monitor monitor;
  for (int i = 0; i < 10; ++i) monitor.interface_frame(i * 1.0);
  EXPECT_FALSE(monitor.worst_interface_hz());
  EXPECT_EQ(monitor.longest_gap_s(), 0);
}

TEST(Monitor, MeasuresTheRateOfSlowFrames) {
  Monitor monitor;
  EXPECT_EQ(monitor.frames_per_s(), 0);
  for (int i = 0; i < 4; ++i) monitor.rendered_frame(i * 8.0);
  EXPECT_NEAR(monitor.frames_per_s(), 0.125, 1e-9);
  for (int i = 0; i < 40; ++i) monitor.rendered_frame(32 + i * 0.1);
  EXPECT_NEAR(monitor.frames_per_s(), 10, 1e-6);
}

TEST(Monitor, KeepsTheLongestLatencyOfTheCamera) {
  Monitor monitor;
  monitor.camera_seen(2);
  monitor.camera_seen(1);
  EXPECT_EQ(monitor.camera_latency_frames(), 2u);
  monitor.reset();
  EXPECT_EQ(monitor.camera_latency_frames(), 0u);
}

}  // namespace
}  // namespace relume::viewer
