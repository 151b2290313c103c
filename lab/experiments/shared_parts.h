// Divides the measurements of an experiment among the ranks of its context. Without ranks, this process measures all.
//
// All ranks run the experiment, call these functions in the same order, and get the same results. Results need
// members_of() (part_bytes.h).
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

#include "compare/shared_work.h"
#include "experiments/experiment.h"
#include "experiments/part_bytes.h"

namespace relume {

/// Throws ExperimentStopped if the first rank has ended, and Error unless this rank is at the same step as the first.
/// `step` describes the step. Requires ranks.
void check_step(const ExperimentContext& context, const std::string& step);

/// Measures a part in the context of its rank, which shares nothing, and returns the result as bytes.
using MeasurePart = std::function<std::string(const ExperimentContext& own, size_t part)>;

/// Results of `count` parts, on all ranks. Requires ranks. Throws ExperimentStopped, and Error.
std::vector<std::string> share_parts(const ExperimentContext& context, const std::string& stage, size_t count,
                                     TaskRanks ranks, const MeasurePart& measure);

/// Results of measure(context, part) for `count` parts, which are dealt out to all ranks. A part must not depend on
/// other parts, and its times do not count: other ranks of its machine measure meanwhile. Throws ExperimentStopped.
template <typename Measure>
auto deal_parts(const ExperimentContext& context, const std::string& stage, int count, const Measure& measure) {
  using Result = std::invoke_result_t<const Measure&, const ExperimentContext&, int>;
  std::vector<Result> results;
  if (!context.ranks) {
    for (int part = 0; part < count; ++part) {
      results.push_back(measure(context, part));
      context.report(stage, (part + 1.0) / count);
    }
    return results;
  }
  const auto measured = share_parts(
      context, stage, static_cast<size_t>(count), TaskRanks::all,
      [&](const ExperimentContext& own, size_t part) { return part_to_bytes(measure(own, static_cast<int>(part))); });
  for (const std::string& bytes : measured) results.push_back(part_from_bytes<Result>(bytes));
  return results;
}

/// Result of measure(context) on the first rank, while others wait: for times, and for files that one rank keeps.
/// Throws ExperimentStopped.
template <typename Measure>
auto measure_on_first(const ExperimentContext& context, const std::string& stage, const Measure& measure) {
  using Result = std::invoke_result_t<const Measure&, const ExperimentContext&>;
  if (!context.ranks) return measure(context);
  const auto measured = share_parts(context, stage, 1, TaskRanks::first,
                                    [&](const ExperimentContext& own, size_t) { return part_to_bytes(measure(own)); });
  return part_from_bytes<Result>(measured.front());
}

}  // namespace relume
