// A session whose frames are timed, and how many frames make equal times.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/session.h"

namespace relume {

/// Reads a clock that only moves forward, seconds. Tests take one that counts work, which every machine does alike.
using FrameClock = std::function<double(const Session&)>;
double wall_clock(const Session& session);

/// Renders one contender. Counts and times are those since the last restart().
class TimedSession {
 public:
  /// `clock` empty: wall_clock().
  TimedSession(const Scene& scene, const RenderSettings& settings, FrameClock clock = {});

  void restart(int seed);
  void render_frame();

  uint32_t frames() const { return static_cast<uint32_t>(frame_s_.size()); }
  const std::vector<double>& frame_s() const { return frame_s_; }
  double time_s() const { return time_s_; }
  /// Mean over the pixels, all frames together.
  double samples_per_pixel() const;
  uint64_t rays() const;
  /// Without "build".
  std::vector<PassTime> passes() const;

  Session& session() { return session_; }
  const Session& session() const { return session_; }

 private:
  Session session_;
  FrameClock clock_;
  std::vector<double> frame_s_;
  double time_s_ = 0;
  std::vector<PassTime> passes_before_;
};

/// Whether curves have a point after so many frames: powers of two, and halfway between them.
bool is_measured(uint32_t frames);

/// Sums of the first 1, 2, … frames. Single frames that took much longer than their neighbours (another program had the
/// processor) count as their neighbours do: a running median over nine frames. The first counts as it is, as techniques
/// prepare in it; and all do if more than one in sixteen take long, which is a technique's own rhythm.
std::vector<double> cumulative_time(const std::vector<double>& frame_s);

struct EqualTime {
  std::vector<uint32_t> frames;  ///< one number a contender
  std::vector<double> time_s;    ///< expected
  /// Longest over shortest time, minus 1.
  double spread() const;
};

/// How many frames each contender may render in about `budget_s`. `cumulative` has each one's cumulative_time() up to
/// 1.3 budgets at least, or one frame where that takes longer. Whole frames rarely fill a budget exactly: a common time
/// up to 20 % off it is chosen at which the contenders' times differ by 1 % at most, or else as little as possible.
EqualTime equal_time(const std::vector<std::vector<double>>& cumulative, double budget_s);

}  // namespace relume
