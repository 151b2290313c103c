#include "sampling/alias_table.h"

namespace relume {

std::vector<AliasEntry> build_alias_table(std::span<const float> weights) {
  std::vector<AliasEntry> entries(weights.size());
  for (size_t i = 0; i < weights.size(); ++i) entries[i].pmf = weights[i];
  std::vector<double> shares(weights.size());
  std::vector<uint32_t> stack(weights.size());
  if (!fill_alias_table(mutable_view_of(entries), mutable_view_of(shares), mutable_view_of(stack))) entries.clear();
  return entries;
}

}  // namespace relume
