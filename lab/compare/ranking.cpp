#include "compare/ranking.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr size_t kFewestRepetitions = 3;

struct Candidate {
  size_t index = 0;
  double median = 0;
  std::optional<Interval> interval = {};
};

std::optional<Interval> interval_of(const ContenderResult& contender, const std::vector<double>& values) {
  if (contender.is_image) return Interval{values.front(), values.front(), 1};
  if (values.size() < kFewestRepetitions) return std::nullopt;
  return median_interval(values);
}

bool lies_above(const Candidate& a, const Candidate& b) {
  return a.interval && b.interval && a.interval->low > b.interval->high;
}

}  // namespace

bool is_ranked(const ContenderResult& contender) { return most_nonfinite(contender) == 0; }

std::vector<size_t> leaders(const Comparison& comparison, const Figure& figure, bool with_images) {
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < comparison.contenders.size(); ++i) {
    const ContenderResult& contender = comparison.contenders[i];
    if (!is_ranked(contender) || (contender.is_image && !with_images)) continue;
    const std::vector<double> values = values_of(contender, figure);
    const double middle = median(values);
    if (std::isfinite(middle)) candidates.push_back({i, middle, interval_of(contender, values)});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.median < b.median; });
  std::vector<size_t> result;
  for (const Candidate& candidate : candidates) {
    if (!lies_above(candidate, candidates.front())) result.push_back(candidate.index);
  }
  return result;
}

}  // namespace relume
