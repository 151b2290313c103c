// The page of a comparison, and parts of it that experiments reuse.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "compare/comparison.h"
#include "report/page.h"

namespace relume {

/// Three significant digits: "0.0123", "1.23e-05", "1230".
std::string short_number(double x);

/// The complete page of a comparison. `machine`: as for to_json().
Page comparison_page(const Comparison& comparison, const std::vector<std::pair<std::string, std::string>>& machine);

/// The reference and the contenders' images with their maps. Inspector values are omitted if the page would exceed some
/// 100 MB.
ViewerBlock comparison_images(const Comparison& comparison);
TableBlock comparison_table(const Comparison& comparison);
ChartBlock comparison_curves(const Comparison& comparison);
BarBlock comparison_frame_times(const Comparison& comparison);

}  // namespace relume
