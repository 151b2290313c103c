#include "experiments/shared_parts.h"

#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {

void check_step(const ExperimentContext& context, const std::string& step) {
  const std::optional<std::string> first = context.ranks->share(step);
  if (!first) throw ExperimentStopped();
  if (*first == step) return;
  throw Error(fmt::format(
      "this rank is at '{}' but rank 0 at '{}'; give all ranks the same program, options and scenes", step, *first));
}

std::vector<std::string> share_parts(const ExperimentContext& context, const std::string& stage, size_t count,
                                     TaskRanks ranks, const MeasurePart& measure) {
  check_step(context, fmt::format("{}, {} parts", stage, count));
  SharedTasks parts{.tasks = std::vector<size_t>(count), .ranks = ranks, .run = {}};
  std::iota(parts.tasks.begin(), parts.tasks.end(), size_t{0});
  parts.progress = [&](double fraction) { context.report(stage, fraction); };
  parts.run = [&](size_t part, const std::stop_token& stop,
                  const SharedTasks::Progress& progress) -> std::optional<std::string> {
    ExperimentContext own = context;
    own.ranks = nullptr;
    own.stop = stop;
    own.progress = [&progress](const std::string&, double fraction) { progress(fraction); };
    try {
      return measure(own, part);
    } catch (const ExperimentStopped&) {
      return std::nullopt;
    }
  };
  const std::optional<std::vector<std::string>> results = context.ranks->gather(parts, context.stop);
  if (!results) throw ExperimentStopped();
  const bool is_first = context.ranks->is_first();
  const std::optional<std::string> shared = context.ranks->share(is_first ? part_to_bytes(*results) : std::string());
  if (!shared) throw ExperimentStopped();
  return is_first ? *results : part_from_bytes<std::vector<std::string>>(*shared);
}

}  // namespace relume
