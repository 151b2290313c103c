// A session with timed frames, and the frame counts that give equal times.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/session.h"

namespace relume {

/// Reads a monotonic clock, seconds. Tests use one that counts work, independent of the machine.
using FrameClock = std::function<double(const Session&)>;
double wall_clock(const Session& session);

/// Renders one contender. Counts and times start at the last restart().
class TimedSession {
 public:
  /// `clock` empty: wall_clock().
  TimedSession(const Scene& scene, const RenderSettings& settings, FrameClock clock = {});

  void restart(int seed);
  void render_frame();

  int first_seed() const { return first_seed_; }  ///< that of the settings

  uint32_t frames() const { return static_cast<uint32_t>(frame_s_.size()); }
  const std::vector<double>& frame_s() const { return frame_s_; }
  double time_s() const { return time_s_; }
  /// Mean over the pixels, summed over all frames.
  double samples_per_pixel() const;
  uint64_t rays() const;
  /// Times of the passes, without "build".
  std::vector<PassTime> passes() const;

  Session& session() { return session_; }
  const Session& session() const { return session_; }

 private:
  Session session_;
  int first_seed_;
  FrameClock clock_;
  std::vector<double> frame_s_;
  double time_s_ = 0;
  std::vector<PassTime> passes_before_;
};

/// Whether curves have a point after `frames` frames: powers of two, and the midpoints between them.
bool is_measured(uint32_t frames);

/// Sums of the first 1, 2, … frames. Isolated frames that took much longer than their neighbours (another program used
/// the processor) are replaced by a running median over nine frames. The first frame is kept, because techniques
/// prepare in it. All are kept if more than one in sixteen is slow, as in techniques with periodic work.
std::vector<double> cumulative_time(const std::vector<double>& frame_s);

struct EqualTime {
  std::vector<uint32_t> frames;  ///< one per contender
  std::vector<double> time_s;    ///< expected
  /// Longest time divided by the shortest, minus 1.
  double spread() const;
};

/// Frame counts with which each contender takes about `budget_s`. `cumulative` holds each contender's cumulative_time()
/// up to at least 1.3 budgets, or one frame if that takes longer. Whole frames rarely fill a budget exactly. Chooses a
/// common time within 20 % of it at which the times differ by at most 1 %, or else as little as possible.
EqualTime equal_time(const std::vector<std::vector<double>>& cumulative, double budget_s);

}  // namespace relume
