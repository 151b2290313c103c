// The frames of a sequence on several ranks.
#pragma once

#include <filesystem>

#include "ranks/ranks_run.h"

namespace relume::ranks {

/// Whether a file is the checkpoint of a sequence on several ranks.
bool is_sequence_file(const std::filesystem::path& file);

/// Renders the segments that this rank is dealt, until no work is left. Techniques that use earlier frames first render
/// the `--warmup` frames before a segment.
void run_frame_worker(const cli::RenderOptions& options, cli::RenderSetup& setup, RankLink& link);

/// Deals out the frames, and renders and writes them, on rank 0. Throws Error.
RanksEnd run_frame_job(const RanksRun& run);

}  // namespace relume::ranks
