// Parts of an image in which something is to be seen: a caustic, a shadow, what a mirror shows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare/comparison.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/study.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// MSE of a contender's last frame in the region, one value a repetition, without the reference's own noise.
std::vector<double> region_errors(const Comparison& comparison, std::string_view name, const Rectangle& region);
/// Of a's errors there over b's. Means decide: a median would overlook what path tracing finds rarely and brightly.
Ratio region_ratio(const Comparison& comparison, std::string_view a, std::string_view b, const Rectangle& region);

/// What each repetition's last frame differs by from the mean of the others, as a variance: noise alone, whatever a
/// contender's images lack beside the reference. Needs two repetitions.
std::vector<double> region_variances(const Comparison& comparison, std::string_view name, const Rectangle& region);

/// Mean luminance of the region. Images have one size, as in all that follows.
double region_mean(const Image& image, const Rectangle& region);

/// Which share of the reference's contrast in the region an image has kept: the slope of its luminance over that of the
/// reference, both cut off at 1 as a display does. 1: all of it, 0: a flat image. Noise leaves it as it is.
double contrast_kept(const Image& image, const Image& reference, const Rectangle& region);

/// Which share of the reference's detail in the region an image has kept: the same of the differences between pixels
/// side by side, and one above the other. Blur makes it small; noise leaves it as it is.
double detail_kept(const Image& image, const Image& reference, const Rectangle& region);

/// The comparison's images with crops at the regions.
ViewerBlock region_images(const std::string& title, const Comparison& comparison,
                          const std::vector<Rectangle>& regions);

/// Sets a square image for everybody: `side` pixels, 24 in a quick run.
void use_square(const ExperimentContext& context, int side, StudyOptions& options);
/// What use_square() sets, for ExperimentResult::setup: "160 × 160".
std::string square_text(const ExperimentContext& context, int side);

}  // namespace relume
