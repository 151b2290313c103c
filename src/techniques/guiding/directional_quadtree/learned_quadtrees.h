// Quadtrees that learn one quantity in all regions, radiance or importance.
#pragma once

#include <iosfwd>

#include "frame/pass.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtrees.h"
#include "techniques/guiding/directional_quadtree/quadtrees.h"
#include "techniques/spatial/octree/snapshot.h"

namespace relume {

/// The trees, the sums that outlast a frame, and the copy that an epoch samples. In a frame with a new octree, call
/// prepare(), begin_frame(), adapt() and populate(), else only begin_frame().
class LearnedQuadtrees {
 public:
  LearnedQuadtrees(uint32_t bit_count, Memory& memory)
      : trees_(bit_count, 0, memory),
        next_trees_(bit_count, 0, memory),
        weights_(memory),
        next_weights_(memory),
        successors_(memory),
        moved_(memory) {}

  /// Whether there is a tree of `bit_count` bits for each of `regions` leaf slots.
  bool fit(uint32_t bit_count, uint32_t regions) const {
    return trees_.size() == regions && (regions == 0 || trees_.bit_count() == bit_count);
  }
  /// Allocates what adapt() and populate() need for `regions` leaf slots of the next octree. `remembers`, here and
  /// below: whether sums outlast the frame. Changes neither trees nor sums.
  void prepare(uint32_t bit_count, uint32_t regions, bool remembers, bool learns_fractions);
  /// Decides which trees the frame samples.
  void begin_frame(const FrameContext& frame) { snapshot_.begin_frame(frame.backend, frame.begins_epoch, trees_); }
  /// Adapts the trees of the previous octree. `kernel`: all but its members trees, weights and moved. Allocates
  /// nothing.
  void adapt(const FrameContext& frame, AdaptQuadtreesKernel kernel, bool remembers);
  /// Creates the trees of the current octree's leaves: copies of their origins' (`previous`, by leaf slot) if `keep`,
  /// else uniform ones. `remembers`: copies the sums, too. Allocates nothing.
  void populate(const FrameContext& frame, View<const uint32_t> previous, bool keep, bool remembers);
  /// Removes all trees and sums.
  void clear(uint32_t bit_count);

  const Quadtrees& trees() const { return trees_; }
  /// The trees that populate() creates.
  Quadtrees& next_trees() { return next_trees_; }
  /// The trees from which the frame's paths sample.
  Quadtrees& sampled() { return snapshot_.of(trees_); }
  /// Whether those are of an earlier frame.
  bool frozen() const { return snapshot_.frozen(); }
  uint64_t migrations() const { return moved_.read(); }  ///< in the last frame
  size_t weight_bytes() const { return weights_.size() * sizeof(QuadtreeWeights); }
  size_t memory_bytes() const {
    return trees_.memory_bytes() + next_trees_.memory_bytes() + snapshot_.memory_bytes() + weights_.memory_bytes() +
           next_weights_.memory_bytes() + successors_.memory_bytes();
  }
  void save(std::ostream& out) const;
  /// Sets the stream's failbit if the trees are invalid or the number of sums differs from theirs.
  void load(std::istream& in, uint32_t bit_count);

 private:
  Quadtrees trees_;
  Quadtrees next_trees_;  ///< buffer for the next octree, swapped with trees_
  Snapshot<Quadtrees> snapshot_;
  Array<QuadtreeWeights> weights_;       ///< by leaf slot; empty if none outlast a frame
  Array<QuadtreeWeights> next_weights_;  ///< buffer for the next octree, swapped with weights_
  Array<uint32_t> successors_;           ///< number of next regions, by origin
  KernelValue<uint64_t> moved_;          ///< number of migrations in the last frame
};

}  // namespace relume
