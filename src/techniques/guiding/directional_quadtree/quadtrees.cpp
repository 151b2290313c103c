#include "techniques/guiding/directional_quadtree/quadtrees.h"

#include "frame/primitives/fill.h"

namespace relume {

bool is_quadtree(const DirectionalQuadtree& tree) {
  const uint32_t groups = tree.bit_count / 4;
  if (tree.bits.rank(tree.bit_count) != groups - 1) return false;
  uint32_t depths[BitField::kWords * 8] = {1};
  uint32_t next = 1;  // group of the next inner node's children
  for (uint32_t bit = 0; bit < tree.bit_count; ++bit) {
    if (!tree.bits.get(bit)) continue;
    // Parents must precede their children, or walking up would not end.
    if (bit / 4 >= next || depths[bit / 4] >= kMaxQuadtreeDepth) return false;
    depths[next++] = depths[bit / 4] + 1;
  }
  return true;
}

Quadtrees Quadtrees::copy(Backend& backend) const {
  Quadtrees result(bit_count_, 0, memory());
  relume::copy(backend, "cdq.copy", words_, result.words_);
  relume::copy(backend, "cdq.copy", fractions_, result.fractions_);
  return result;
}

void Quadtrees::load(std::istream& in) {
  read_array(in, words_);
  read_array(in, fractions_);
  const QuadtreeArray trees = write();
  bool valid = words_.size() % trees.words_per_tree() == 0 && (fractions_.empty() || fractions_.size() == size());
  for (const float fraction : fractions_.read()) valid = valid && fraction > 0.0f && fraction <= 1.0f;
  for (uint32_t i = 0; valid && i < trees.tree_count(); ++i) valid = is_quadtree(trees.load(i));
  if (valid) return;
  words_.clear();
  fractions_.clear();
  in.setstate(std::ios::failbit);
}

}  // namespace relume
