#include "sampling/alias_table.h"

#include <cmath>

namespace relume {

std::vector<AliasEntry> build_alias_table(std::span<const float> weights) {
  double sum = 0;
  for (const float w : weights) sum += w;
  if (!(sum > 0) || !std::isfinite(sum)) return {};

  const size_t n = weights.size();
  std::vector<AliasEntry> entries(n);
  std::vector<double> scaled(n);
  std::vector<uint32_t> small;
  std::vector<uint32_t> large;
  for (size_t i = 0; i < n; ++i) {
    const double pmf = weights[i] / sum;
    scaled[i] = pmf * static_cast<double>(n);
    entries[i] = {1.0f, static_cast<uint32_t>(i), static_cast<float>(pmf)};
    (scaled[i] < 1.0 ? small : large).push_back(static_cast<uint32_t>(i));
  }
  while (!small.empty() && !large.empty()) {
    const uint32_t poor = small.back();
    const uint32_t rich = large.back();
    small.pop_back();
    entries[poor].keep = static_cast<float>(scaled[poor]);
    entries[poor].alias = rich;
    scaled[rich] -= 1.0 - scaled[poor];
    if (scaled[rich] < 1.0) {
      large.pop_back();
      small.push_back(rich);
    }
  }
  return entries;
}

}  // namespace relume
