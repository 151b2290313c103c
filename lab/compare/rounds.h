// Repetitions of a comparison. Contenders alternate frame by frame, so other load on the machine affects them equally.
#pragma once

#include <functional>
#include <memory>
#include <stop_token>
#include <vector>

#include "compare/comparison.h"
#include "compare/timed_session.h"

namespace relume {

/// Sessions in the order of the contenders.
using Sessions = std::vector<std::unique_ptr<TimedSession>>;

/// Number of frames that each contender renders per frame of the animation, or of the still scene.
struct FramePlan {
  std::vector<uint32_t> frames;  ///< fixed counts; empty: until `samples` is reached
  double samples = 0;            ///< per pixel, on average
};

/// Measures frame times and computes the plan. Returns std::nullopt if `stop` was requested.
std::optional<EqualTime> plan_equal_time(const Sessions& sessions, const std::vector<float>& times_s, double budget_s,
                                         const std::stop_token& stop, const std::function<void(double)>& progress);

/// Renders one repetition with each contender. `references` has one entry per frame of the animation, or a single one.
/// `images` receives each contender's final image. Returns false if `stop` was requested.
bool run_repetition(const Sessions& sessions, const ComparisonOptions& options, const FramePlan& plan,
                    const std::vector<Reference>& references, int repetition, const std::stop_token& stop,
                    std::vector<Repetition>& results, std::vector<Image>& images,
                    const std::function<void(double)>& progress);

}  // namespace relume
