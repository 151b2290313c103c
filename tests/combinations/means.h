// Mean luminance and colour of images of open_box() (support/scenes.h), and their deviations from path tracing.
#pragma once

#include <array>
#include <string>

#include "combinations/cells.h"
#include "render/render_settings.h"

namespace relume::support {

inline constexpr int kSize = 20;  ///< edge of the images, in pixels

/// Number of means: of luminance, red, green and blue.
inline constexpr int kMeans = 4;
using Means = std::array<double, kMeans>;

/// Means over the images of several seeds, and their standard errors.
struct Mean {
  Means value = {};
  Means error = {};
  int seeds = 0;
};

/// Number of frames of a reference: all or a quarter.
enum class ReferenceLength {
  whole,    ///< for cells with standard errors of at least 0.25 %
  quarter,  ///< of at least 0.5 %
};

/// Means of path tracing, measured once per process for each number of bounces and length. The host renders them, even
/// if a device renders the cells. Most cells have the default number of bounces. References of other numbers have fewer
/// seeds: each serves a single preset, which renders in less time than its reference. The error of a Deviation includes
/// that of the reference. With a quarter of the frames, the reference has a third of the standard error of path tracing
/// in a cell of ten seeds.
const Mean& reference(int max_bounces, ReferenceLength length);

/// Adapts settings to the small images.
RenderSettings scaled(RenderSettings settings);

using Deviations = std::array<Deviation, kMeans>;

/// Renders at least `least_seeds` seeds, and more until the standard error of luminance is at most `most_error`. Each
/// image has frames before and after a move of the camera.
Deviations measure_deviations(const RenderSettings& settings, const Mean& truth, double most_error, int least_seeds);

/// Number of standard errors up to which a deviation counts as noise.
using NoiseLimit = double (*)(const Deviation& deviation);

/// Description of wrong means; empty if they are correct within `bias` and noise.
std::string describe_problem(const Deviations& deviations, double bias, double most_error, NoiseLimit limit);

}  // namespace relume::support
