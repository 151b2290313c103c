// `relume render` on the ranks of a launcher.
#pragma once

#include "cli/render_job.h"

namespace relume::ranks {

/// Whether run_on_ranks() renders: a launcher started several ranks, or the checkpoint is of such a render. With one
/// rank, a render with a checkpoint, so that any number of ranks can continue it.
bool runs_on_ranks(const cli::RenderOptions& options);

/// Runs this process's rank. Rank 0 also deals out the work, and alone writes and prints. Returns the exit code. Throws
/// Error.
int run_on_ranks(const cli::RenderOptions& options, const cli::Verbosity& verbosity);

}  // namespace relume::ranks
