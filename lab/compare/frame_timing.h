// How long frames take, without a look at what they show.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "compare/contender.h"
#include "compare/timed_session.h"
#include "metrics/statistics.h"

namespace relume {

struct TimedContender {
  std::string name;
  RenderSettings settings;
};

struct FrameTiming {
  std::string name;
  double ms = 0;  ///< of a frame, median
  Interval ms_interval = {};
  double ratio = 1;  ///< of a frame's time to that of the first contender's frame of the same round, median
  Interval ratio_interval = {};
  std::vector<std::pair<std::string, double>> pass_ms = {};  ///< of a frame, means
};

/// Renders `frames` frames of each contender after a quarter as many that are not counted, in which caches fill.
/// Contenders take turns frame by frame: whatever else the machine does meets all alike. `clock` empty: wall_clock().
/// std::nullopt if `stop` was requested.
std::optional<std::vector<FrameTiming>> time_frames(const Scene& scene, const std::vector<TimedContender>& contenders,
                                                    int frames, const std::stop_token& stop,
                                                    const std::function<void(double)>& progress,
                                                    const FrameClock& clock = {});

/// A line for each contender: name, ms, ratio to the first, bounds of both, and ms by pass.
std::string to_csv(const std::vector<FrameTiming>& timings);

}  // namespace relume
