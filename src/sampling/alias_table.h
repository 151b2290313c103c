// Discrete distributions sampled in constant time by Walker's alias method.
#pragma once

#include <limits>
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

/// Builds an alias table in place ([Vose91]). On input, `pmf` of each entry is its weight ≥ 0. Returns false, with
/// invalid entries, if the sum of the weights is zero or not finite. `shares`, `stack`: temporary memory, one element
/// per entry.
RELUME_HD inline bool fill_alias_table(View<AliasEntry> entries, View<double> shares, View<uint32_t> stack) {
  const uint32_t n = entries.size;
  double sum = 0;
  for (uint32_t i = 0; i < n; ++i) sum += static_cast<double>(entries.data[i].pmf);
  if (!(sum > 0 && sum <= std::numeric_limits<double>::max())) return false;
  // One stack grows from the front and one from the back. Together they have at most n elements.
  uint32_t small = 0;
  uint32_t large = 0;
  for (uint32_t i = 0; i < n; ++i) {
    const double pmf = static_cast<double>(entries.data[i].pmf) / sum;
    shares.data[i] = pmf * static_cast<double>(n);
    entries.data[i] = {1.0f, i, static_cast<float>(pmf)};
    stack.data[shares.data[i] < 1.0 ? small++ : n - ++large] = i;
  }
  while (small > 0 && large > 0) {
    const uint32_t poor = stack.data[--small];
    const uint32_t rich = stack.data[n - large];
    entries.data[poor].keep = static_cast<float>(shares.data[poor]);
    entries.data[poor].alias = rich;
    shares.data[rich] -= 1.0 - shares.data[poor];
    if (shares.data[rich] < 1.0) {
      --large;
      stack.data[small++] = rich;
    }
  }
  return true;
}

/// Entries for weights ≥ 0; none if their sum is zero or not finite.
std::vector<AliasEntry> build_alias_table(std::span<const float> weights);

}  // namespace relume
