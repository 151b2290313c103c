// Verdicts that noise alone does not decide.
#pragma once

#include <string>

#include "metrics/estimate.h"
#include "report/page.h"

namespace relume {

/// Whether something is negative: if its 95 % interval is, or is not; else that is undecided.
const char* verdict_below(const Estimate& difference);

/// "0.0012 ± 0.0001": half of the 95 % interval.
std::string with_noise(const Estimate& estimate);

}  // namespace relume
