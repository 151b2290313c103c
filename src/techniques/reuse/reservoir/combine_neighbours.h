// Combinations of a pixel's reservoir with those of neighbouring pixels, for all types of samples.
#pragma once

#include "techniques/reuse/reservoir/neighbours.h"
#include "techniques/reuse/reservoir/reservoir.h"

namespace relume {

/// Combines by PairwiseCombination. `here(i, neighbour)`: p̂ at the pixel of the sample of neighbour i, which it may
/// move there. `there(i)`: p̂ of the pixel's own sample at neighbour i. Both are called only for reservoirs with a
/// sample.
template <typename Sample, typename Here, typename There>
RELUME_HD inline Reservoir<Sample> combine_neighbours_pairwise(const Reservoir<Sample>& own,
                                                               const View<const Reservoir<Sample>>& reservoirs,
                                                               const ReuseNeighbours& near, const Here& here,
                                                               const There& there, ChoiceNumbers& numbers) {
  PairwiseCombination<Sample> combination(own, near.count);
  for (uint32_t i = 0; i < near.count; ++i) {
    Reservoir<Sample> neighbour = reservoirs[near.pixels[i]];
    const float target_here = neighbour.weight > 0.0f ? here(i, neighbour) : 0.0f;
    const float target_there = own.weight > 0.0f ? there(i) : 0.0f;
    combination.add(neighbour, target_here, target_there, numbers.next());
  }
  return combination.finish(numbers.next());
}

/// Combines by BasicCombination. `here(i, sample)`: p̂ at the pixel of a sample of neighbour i. `there(i, sample)`: p̂ of
/// a sample of the pixel at neighbour i.
template <typename Sample, typename Here, typename There>
RELUME_HD inline Reservoir<Sample> combine_neighbours_basic(const Reservoir<Sample>& own,
                                                            const View<const Reservoir<Sample>>& reservoirs,
                                                            const ReuseNeighbours& near, const Here& here,
                                                            const There& there, ChoiceNumbers& numbers) {
  BasicCombination<Sample> combination;
  combination.add(own, 0, own.target, 0.0f);
  for (uint32_t i = 0; i < near.count; ++i) {
    const Reservoir<Sample>& neighbour = reservoirs[near.pixels[i]];
    const float target = neighbour.weight > 0.0f ? here(i, neighbour.sample) : 0.0f;
    combination.add(neighbour, i + 1, target, numbers.next());
  }
  if (!combination.sample().valid()) return combination.finish(0.0f, 0.0f);
  const uint32_t chosen = combination.chosen();
  float of_source = chosen == 0 ? own.target : here(chosen - 1, combination.sample());
  float of_all = own.confidence * of_source;
  for (uint32_t i = 0; i < near.count; ++i) {
    const float target = there(i, combination.sample());
    of_all += reservoirs[near.pixels[i]].confidence * target;
    if (chosen == i + 1) of_source = target;
  }
  return combination.finish(of_source, of_all);
}

}  // namespace relume
