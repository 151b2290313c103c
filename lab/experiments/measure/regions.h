// Measures image regions with features such as caustics, shadows and mirror images.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare/comparison.h"
#include "experiments/measure/pixel_mask.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/study.h"
#include "metrics/estimate.h"
#include "relume/image_io.h"
#include "report/page.h"

namespace relume {

/// MSE of a contender's last frame in the region per repetition, without the reference's noise.
std::vector<double> region_errors(const Comparison& comparison, std::string_view name, const Rectangle& region);
/// Ratio of a's errors over b's in the region. Uses means, since a median would miss path tracing's rare bright
/// samples.
Ratio region_ratio(const Comparison& comparison, std::string_view a, std::string_view b, const Rectangle& region);

/// Squared difference of each repetition's last frame from the mean of the others, scaled to a variance: noise alone,
/// independent of bias. Requires two repetitions.
std::vector<double> region_variances(const Comparison& comparison, std::string_view name, const Rectangle& region);

/// Squared bias of a contender's last frame in the region, without noise. Below three repetitions, its error is
/// unknown. Requires two repetitions.
Estimate region_bias2(const Comparison& comparison, std::string_view name, const Rectangle& region);

/// Mean luminance of the region. Here and below, images have the same size.
double region_mean(const Image& image, const Rectangle& region);
/// Mean luminance of a contender's last frame in the region per repetition.
std::vector<double> region_means(const Comparison& comparison, std::string_view name, const Rectangle& region);

/// Share of the reference's contrast in the region kept by an image: slope of its luminance over the reference's, both
/// clamped to 1 as on a display. 1: all of it, 0: a flat image. Unbiased by noise in the image.
double contrast_kept(const Image& image, const Image& reference, const Rectangle& region);

/// Share of the reference's detail in the region kept by an image: the same slope for differences between horizontal
/// and vertical neighbours. Blur reduces it; noise in the image does not bias it.
double detail_kept(const Image& image, const Image& reference, const Rectangle& region);

/// Images of the comparison with crops at the regions.
ViewerBlock region_images(const std::string& title, const Comparison& comparison,
                          const std::vector<Rectangle>& regions);

/// Sets square images for all contenders: `side` pixels, 24 in a quick run.
void use_square(const ExperimentContext& context, int side, StudyOptions& options);
/// Size set by use_square(), for ExperimentResult::setup: "160 × 160".
std::string square_text(const ExperimentContext& context, int side);

}  // namespace relume
