// Means of images in the scene of the combination table, and their deviations from path tracing.
#pragma once

#include <array>
#include <string>

#include "combinations/cells.h"
#include "render/render_settings.h"

namespace relume::support {

inline constexpr int kSize = 20;  ///< edge of the images, in pixels

/// Luminance, red, green and blue.
inline constexpr int kMeans = 4;
using Means = std::array<double, kMeans>;

/// Means over images of several seeds, and their standard errors.
struct Mean {
  Means value = {};
  Means error = {};
  int seeds = 0;
};

/// Frames of a reference.
enum class ReferenceLength {
  whole,    ///< for standard errors of a cell down to 0.25 %
  quarter,  ///< for 0.5 % or more
};

/// Reference by number of bounces, measured once per process. Many cells have the default number, and single presets
/// others: theirs have fewer seeds, since a reference takes longer than a preset. On the host, also if cells are
/// rendered on a device. The error of a Deviation includes that of the reference. A quarter of the frames has a third
/// of the standard error of path tracing in a cell of ten seeds.
const Mean& reference(int max_bounces, ReferenceLength length);

/// Scales settings to the small images.
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
