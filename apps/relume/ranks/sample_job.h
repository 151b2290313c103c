// A still image on several ranks, seen from rank 0.
#pragma once

#include "ranks/ranks_run.h"

namespace relume::ranks {

/// Renders, merges and writes the image. Throws Error, and UsageError if the techniques allow no sums.
RanksEnd run_sample_job(const RanksRun& run);

}  // namespace relume::ranks
