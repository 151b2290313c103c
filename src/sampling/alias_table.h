// Discrete distributions sampled in constant time by Walker's alias method.
#pragma once

#include <span>
#include <vector>

#include "core/vec.h"
#include "core/view.h"
#include "sampling/choose.h"

namespace relume {

struct AliasEntry {
  float keep;      ///< probability of staying in the chosen bin
  uint32_t alias;  ///< the bin taken otherwise
  float pmf;       ///< probability of this bin
};

struct DiscreteSample {
  uint32_t index;
  float pmf;
  float u;  ///< remainder of the random number, uniform in [0, 1)
};

/// Table over n bins; empty if all weights are zero.
struct AliasTable {
  View<const AliasEntry> entries;

  RELUME_HD bool empty() const { return entries.empty(); }

  RELUME_HD_INLINE DiscreteSample sample(ReusableNumber n) const {
    uint32_t i = choose_evenly(entries.size, n);
    if (!takes_share(entries[i].keep, n)) i = entries[i].alias;
    return {i, entries[i].pmf, n.u};
  }

  RELUME_HD float pmf(uint32_t i) const { return entries[i].pmf; }
};

/// Entries for weights ≥ 0 ([Vose91]); none if their sum is zero or not finite.
std::vector<AliasEntry> build_alias_table(std::span<const float> weights);

}  // namespace relume
