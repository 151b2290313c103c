// Samples whose cells found no slot while paths were traced. They wait in a list, in any order, until the table has
// grown: sums of cells do not depend on the order of their samples, so neither does the image.
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
  int coarser = 0;  ///< levels above the cell of `point`
  bool alone = false;
};

struct OverflowView {
  View<WaitingSample> samples;
  uint32_t* count = nullptr;  ///< additions so far, beyond the end of the list too

  /// Thread-safe. False if the list is full.
  RELUME_HD bool add(const WaitingSample& sample) const {
    const uint32_t i = atomic_fetch_add(count, 1u);
    if (i >= samples.size) return false;
    samples[i] = sample;
    return true;
  }
};

}  // namespace relume
