// Who has the least of a figure, as far as the repetitions can tell.
#pragma once

#include <cstddef>
#include <vector>

#include "compare/comparison.h"

namespace relume {

/// Whether the contender's errors say all: those of one with pixels that are not finite leave out what may be worst.
bool is_ranked(const ContenderResult& contender);

/// Indices of the contenders that may have the least of a figure, by their medians: the one whose median is least, and
/// those whose intervals begin before its own ends. Below three repetitions nobody can be told apart: two values each
/// of two that are alike lie apart in one of three cases. An image made elsewhere is exactly what it is, and is left
/// out unless `with_images`. So are those that are not ranked.
std::vector<size_t> leaders(const Comparison& comparison, const Figure& figure, bool with_images);

}  // namespace relume
