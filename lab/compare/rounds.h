// The repetitions of a comparison: contenders take turns frame by frame, so that whatever else the machine does meets
// all of them alike.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "compare/comparison.h"
#include "compare/timed_session.h"

namespace relume {

/// Sessions of the contenders, in their order.
using Sessions = std::vector<std::unique_ptr<TimedSession>>;

/// How many frames each contender renders of each frame of the animation, or of the still scene.
struct FramePlan {
  std::vector<uint32_t> frames;  ///< fixed counts; empty: as many as `samples` takes
  double samples = 0;            ///< a pixel, on average
};

/// Measures how long frames take and makes the plan. std::nullopt if `stop` was requested.
std::optional<EqualTime> plan_equal_time(const Sessions& sessions, const std::vector<float>& times_s, double budget_s,
                                         const std::stop_token& stop, const std::function<void(double)>& progress);

/// Renders one repetition with each contender; `references` has one entry a frame of the animation, or one.
/// `images` becomes what each contender shows at the end. False if `stop` was requested.
bool run_repetition(const Sessions& sessions, const ComparisonOptions& options, const FramePlan& plan,
                    const std::vector<Reference>& references, int repetition, const std::stop_token& stop,
                    std::vector<Repetition>& results, std::vector<Image>& images,
                    const std::function<void(double)>& progress);

}  // namespace relume
