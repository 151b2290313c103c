// Links simulated by rate and delay.
#include "serve/link_control.h"

#include <algorithm>
#include <cstdint>
#include <deque>

#include <gtest/gtest.h>

namespace relume::serve {
namespace {

constexpr double kPixels = 1280 * 720;

/// Bytes of a frame: falls with the quality, and with the square of the divisor.
double bytes_of(int level) {
  const FrameLevel& choice = kLevels[static_cast<size_t>(level)];
  return 2000 + 0.25 * kPixels * choice.quality / 100.0 / (choice.divisor * choice.divisor);
}

/// A viewer behind a link of this rate and delay. Images are ready 30 times per second.
struct Simulation {
  Simulation(double rate, double delay) : bytes_per_s(rate), delay_s(delay) {}

  double bytes_per_s;
  double delay_s;
  LinkControl control;
  double now_s = 1000;
  double free_s = 1000;  ///< when the link has carried all frames
  uint32_t frames = 0;
  uint64_t views = 0;
  double longest_s = 0;  ///< delay of a frame in the last run
  struct Arrival {
    uint32_t frame;
    double sent_s;
    double at_s;
  };
  std::deque<Arrival> arrivals;

  /// Returns the frames per second that arrive.
  double run(double seconds) {
    constexpr double kStep_s = 1.0 / 300;
    longest_s = 0;
    int arrived = 0;
    const int steps = static_cast<int>(seconds / kStep_s);
    bool waits = false;
    for (int step = 0; step < steps; ++step) {
      now_s += kStep_s;
      for (; !arrivals.empty() && arrivals.front().at_s <= now_s; arrivals.pop_front()) {
        longest_s = std::max(longest_s, now_s - arrivals.front().sent_s);
        control.acknowledged(arrivals.front().frame, now_s);
        ++arrived;
      }
      if (step % 10 == 0) {
        ++views;
        waits = true;
      }
      if (!waits || !control.offer(views, now_s)) continue;
      waits = false;
      free_s = std::max(free_s, now_s) + bytes_of(control.level()) / bytes_per_s;
      arrivals.push_back({++frames, now_s, free_s + delay_s});
      control.sent(frames, now_s);
    }
    return arrived / seconds;
  }
};

TEST(LinkControl, AFastLinkGetsTheBestLevel) {
  Simulation link(1e9, 0.001);
  link.run(20);
  EXPECT_EQ(link.control.level(), 0);
  EXPECT_NEAR(link.run(5), 30, 1);
}

TEST(LinkControl, AnOceanInBetweenStillCarriesThirtyFramesPerSecond) {
  Simulation link(1e8, 0.15);
  link.run(20);
  EXPECT_NEAR(link.run(10), 30, 1.5);
  EXPECT_LE(link.control.level(), 1);
}

TEST(LinkControl, ASlowLinkLowersTheLevelInsteadOfQueueing) {
  Simulation link(8e5, 0.02);
  link.run(20);
  EXPECT_GE(link.control.level(), 3);
  EXPECT_GT(link.run(10), 20);
  EXPECT_LT(link.longest_s, 0.5);
}

TEST(LinkControl, EvenTheSlowestLinkHoldsFewFrames) {
  Simulation link(2e4, 0.05);
  link.run(60);
  EXPECT_EQ(link.control.level(), static_cast<int>(kLevels.size()) - 1);
  link.run(20);
  // At most eight frames of 0.28 s are under way.
  EXPECT_LT(link.longest_s, 8 * bytes_of(link.control.level()) / link.bytes_per_s + 0.5);
}

TEST(LinkControl, ALinkThatRecoversIsUsedAgain) {
  Simulation link(5e5, 0.01);
  link.run(20);
  EXPECT_GE(link.control.level(), 3);
  link.bytes_per_s = 1e9;
  link.run(120);
  EXPECT_LE(link.control.level(), 1);
}

TEST(LinkControl, NothingIsSentToAViewerThatDoesNotAnswer) {
  LinkControl control;
  uint32_t sent = 0;
  for (uint64_t view = 1; view < 1000; ++view) {
    const double now_s = static_cast<double>(view) / 30;
    if (control.offer(view, now_s)) control.sent(++sent, now_s);
  }
  EXPECT_EQ(sent, 2u);
  control.acknowledged(77, 40);  // unknown
  EXPECT_FALSE(control.offer(2000, 40));
  control.acknowledged(2, 41);  // and the one before
  EXPECT_TRUE(control.offer(2001, 41));
}

}  // namespace
}  // namespace relume::serve
