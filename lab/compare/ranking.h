// Ranking of contenders by a figure, as far as the repetitions distinguish them.
#pragma once

#include <cstddef>
#include <vector>

#include "compare/comparison.h"

namespace relume {

/// Whether the contender's errors are complete. Errors exclude non-finite pixels, which may be the worst.
bool is_ranked(const ContenderResult& contender);

/// Indices of the contenders that may have the lowest figure: the one with the lowest median, and those whose intervals
/// overlap its interval; all below three repetitions, where intervals mislead. Excludes unranked contenders and, unless
/// `with_images`, external images, whose figures are exact.
std::vector<size_t> leaders(const Comparison& comparison, const Figure& figure, bool with_images);

}  // namespace relume
