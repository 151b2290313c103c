// Verdicts that take noise into account.
#pragma once

#include <string>

#include "metrics/estimate.h"
#include "report/page.h"

namespace relume {

/// Verdict on whether a difference is negative: holds or fails if its 95 % interval does, otherwise undecided.
const char* verdict_below(const Estimate& difference);

/// "0.0012 ± 0.0001": half the width of the 95 % interval.
std::string with_noise(const Estimate& estimate);

}  // namespace relume
