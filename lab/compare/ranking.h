// Ranking of contenders by a figure, as far as the repetitions distinguish them.
#pragma once

#include <cstddef>
#include <vector>

#include "compare/comparison.h"

namespace relume {

/// Whether the contender's errors are complete. Errors exclude non-finite pixels, which may be the worst.
bool is_ranked(const ContenderResult& contender);

/// Indices of the contenders that may have the lowest figure: the one with the lowest median, and those whose intervals
/// overlap its interval. Below three repetitions, contenders cannot be distinguished: two values each of equal
/// contenders are disjoint in one of three cases. Unranked contenders are excluded, as are external images, whose
/// figures are exact, unless `with_images`.
std::vector<size_t> leaders(const Comparison& comparison, const Figure& figure, bool with_images);

}  // namespace relume
