// A still image on several ranks, seen from rank 0.
#pragma once

#include <string>

#include "ranks/ranks_run.h"

namespace relume::ranks {

/// Renders, merges and writes the image. Throws Error, and UsageError if the techniques allow no sums.
RanksEnd run_sample_job(const RanksRun& run);

/// How to continue a render whose ranks are lost, for messages.
std::string way_to_continue(const cli::RenderOptions& options);

}  // namespace relume::ranks
