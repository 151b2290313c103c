#include "experiments/measure/settling.h"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "metrics/statistics.h"

namespace relume {
namespace {

/// Mean of kFramesOfSettling frames from `begin` on, by runs.
std::vector<double> window(const Adaptation& adaptation, size_t begin) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs) {
    const auto first = run.begin() + static_cast<std::ptrdiff_t>(begin);
    means.push_back(mean({first, first + static_cast<std::ptrdiff_t>(kFramesOfSettling)}));
  }
  return means;
}

}  // namespace

Ratio over_settled(const Settling& settling, size_t begin) {
  if (!settling.has_fresh()) return settling.after.over_plateau(begin, kFramesOfSettling);
  return error_ratio(window(settling.after, begin), window(settling.fresh, begin));
}

size_t frames_until_settled(const Settling& settling) {
  const size_t frames = settling.after.runs.front().size();
  for (size_t begin = 0; begin + kFramesOfSettling <= frames; ++begin) {
    const Ratio ratio = over_settled(settling, begin);
    if (std::isfinite(ratio.interval.high) && ratio.value <= kSettled) return begin + 1;
  }
  return 0;
}

std::string settled_text(const Settling& settling) {
  const size_t frame = frames_until_settled(settling);
  return frame > 0 ? fmt::format("from frame {} on", frame)
                   : fmt::format("not within {} frames", settling.after.runs.front().size());
}

}  // namespace relume
