// Frame times, independent of image content.
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
  double ms = 0;  ///< per frame, median
  Interval ms_interval = {};
  double ratio = 1;  ///< frame time relative to the first contender's frame of the same round, median
  Interval ratio_interval = {};
  std::vector<std::pair<std::string, double>> pass_ms = {};  ///< per frame, means
};

/// Renders `frames` frames of each contender, after a quarter as many uncounted ones that fill caches. Contenders
/// alternate frame by frame, so other load on the machine affects them equally. `clock` empty: wall_clock(). Returns
/// std::nullopt if `stop` was requested.
std::optional<std::vector<FrameTiming>> time_frames(const Scene& scene, const std::vector<TimedContender>& contenders,
                                                    int frames, const std::stop_token& stop,
                                                    const std::function<void(double)>& progress,
                                                    const FrameClock& clock = {});

/// One line per contender: name, ms, ratio to the first, bounds of both, and ms per pass.
std::string to_csv(const std::vector<FrameTiming>& timings);

}  // namespace relume
