#include "experiments/measure/estimate.h"

#include <fmt/format.h>

#include "compare/comparison_page.h"

namespace relume {

const char* verdict_below(const Estimate& difference) {
  const double noise = difference.half_width();
  if (difference.value < -noise) return kVerdictHolds;
  return difference.value > noise ? kVerdictFails : kVerdictUndecided;
}

std::string with_noise(const Estimate& estimate) {
  return fmt::format("{} ± {}", short_number(estimate.value), short_number(estimate.half_width()));
}

}  // namespace relume
