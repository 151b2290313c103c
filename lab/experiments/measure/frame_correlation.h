// Correlations between frames and between pixels, and the errors that estimates for the mean of frames have, over
// independent runs.
#pragma once

#include <cstddef>
#include <vector>

namespace relume {

/// Values of a run: by frame, by pixel.
using RunFrames = std::vector<std::vector<float>>;

/// Mean of the first `frames` frames of each run, by run and pixel.
std::vector<std::vector<double>> run_means(const std::vector<RunFrames>& runs, size_t frames);

/// Variance of the runs' means, averaged over the pixels. Requires two runs.
double variance_over_runs(const std::vector<std::vector<double>>& means);

/// Variance of the mean of the first `frames` frames that blocks of `block` of them suggest: the spread of the blocks'
/// means in a run, averaged over pixels and runs. Blocks of one frame: as for independent frames. Requires two blocks.
double variance_by_blocks(const RunFrames& run, size_t frames, size_t block);

/// Correlation of frames `lag` apart, from frame `begin` on, about each pixel's mean over all runs: for lags 0, 1, …,
/// `most`. Covariances and variances are averaged over pixels, frames and runs.
std::vector<double> frame_correlations(const std::vector<RunFrames>& runs, size_t begin, size_t most);

/// Correlation of the errors of pixels `lag` columns apart in the last frame, for lags 0, 1, …, `most`. `width`: of the
/// image in whose rows the pixels lie; `pixels`: their indices, ascending, in the order of the values.
std::vector<double> pixel_correlations(const std::vector<RunFrames>& runs, const std::vector<size_t>& pixels,
                                       size_t width, size_t most);

}  // namespace relume
