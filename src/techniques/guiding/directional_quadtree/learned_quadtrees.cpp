#include "techniques/guiding/directional_quadtree/learned_quadtrees.h"

#include <utility>

#include "core/stream_io.h"
#include "frame/primitives/fill.h"

namespace relume {

void LearnedQuadtrees::prepare(uint32_t bit_count, uint32_t regions, bool remembers, bool learns_fractions) {
  next_trees_.reset(bit_count, regions, learns_fractions);
  if (remembers) {
    weights_.reserve(trees_.size());
    successors_.reset(trees_.size(), kUninitialized);
    next_weights_.reset(regions, kUninitialized);
  }
  moved_.write() = 0;
}

void LearnedQuadtrees::adapt(const FrameContext& frame, AdaptQuadtreesKernel kernel, bool remembers) {
  if (remembers && weights_.size() != trees_.size()) resize(frame.backend, "cdq.adapt", weights_, trees_.size());
  kernel.trees = trees_.view();
  kernel.weights = weights_.mutable_view();
  kernel.moved = moved_.mutable_view();
  frame.launch("cdq.adapt", kernel, {trees_.size(), 1, 1});
}

void LearnedQuadtrees::populate(const FrameContext& frame, View<const uint32_t> previous, bool keep, bool remembers) {
  const Grid regions{next_trees_.size(), 1};
  const PopulateQuadtreesKernel kernel{previous, keep ? trees_.view() : QuadtreeArray{}, next_trees_.view()};
  frame.launch("cdq.populate", kernel, regions);
  if (!remembers || !keep) weights_.clear();
  if (!remembers) return std::swap(trees_, next_trees_);
  successors_.reset(weights_.size(), kUninitialized);
  if (!weights_.empty()) {
    fill(frame.backend, "cdq.populate", successors_.mutable_view(), 0u);
    frame.launch("cdq.populate", CountSuccessorsKernel{previous, successors_.mutable_view()}, regions);
  }
  const InheritWeightsKernel inherit{previous, successors_.view(), weights_.view(), next_weights_.mutable_view()};
  frame.launch("cdq.populate", inherit, regions);
  std::swap(trees_, next_trees_);
  weights_.swap(next_weights_);
}

void LearnedQuadtrees::clear(uint32_t bit_count) {
  trees_ = Quadtrees(bit_count, 0, trees_.memory());
  snapshot_.reset();
  weights_.clear();
}

void LearnedQuadtrees::save(std::ostream& out) const {
  trees_.save(out);
  snapshot_.save(out);
  write_array(out, weights_);
}

void LearnedQuadtrees::load(std::istream& in, uint32_t bit_count) {
  clear(bit_count);
  trees_.load(in);
  snapshot_.load(in, Quadtrees(bit_count, 0, trees_.memory()));
  read_array(in, weights_);
  if (!weights_.empty() && weights_.size() != trees_.size()) in.setstate(std::ios::failbit);
}

}  // namespace relume
