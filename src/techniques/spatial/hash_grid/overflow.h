// Samples whose keys found no slot while paths were traced. They wait in an unordered list until the table has grown.
// The image does not depend on their order, because the sums of cells do not.
#pragma once

#include "core/fixed_point.h"
#include "core/view.h"
#include "techniques/spatial/hash_grid/cell_key.h"

namespace relume {

/// The arguments of one addition to a cell.
struct WaitingSample {
  CellPoint point;
  Rgb value{0};
  float weight = 0;
  int coarser = 0;  ///< levels of the target above the cell of `point`; −1: below
  bool alone = false;
};

struct OverflowView {
  View<WaitingSample> samples;
  View<uint32_t> count;  ///< one element: additions so far, including those beyond the end of the list

  /// Thread-safe. False if the list is full.
  RELUME_HD bool add(const WaitingSample& sample) const {
    const uint32_t i = atomic_fetch_add(&count[0], 1u);
    if (i >= samples.size) return false;
    samples[i] = sample;
    return true;
  }
};

}  // namespace relume
