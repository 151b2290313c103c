// The direction sampling "cdq" as a pass, which runs after the octree's.
#pragma once

#include "core/stream_io.h"
#include "frame/pass.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtrees.h"
#include "techniques/guiding/directional_quadtree/mixture_fraction.h"
#include "techniques/guiding/directional_quadtree/settings.h"
#include "techniques/spatial/octree/octree_pass.h"
#include "techniques/spatial/octree/snapshot.h"

namespace relume {

/// Whether the bits are a valid tree: the number of inner nodes matches that of groups, parents precede their children,
/// and no leaf is deeper than kMaxQuadtreeDepth. Traversals rely on nothing else.
bool is_quadtree(const DirectionalQuadtree& tree);

/// The quadtrees of all regions, by leaf slot, and the learned fractions of directions from the BSDF.
class Quadtrees {
 public:
  explicit Quadtrees(uint32_t bit_count, uint32_t regions = 0, Memory& memory = host_memory())
      : bit_count_(bit_count), words_(memory), fractions_(memory) {
    words_.reset(regions * (bit_count / 32));
  }

  QuadtreeArray view() { return {words_.mutable_view(), bit_count_}; }
  /// The trees for host code.
  QuadtreeArray write() { return {mutable_view_of(words_.write()), bit_count_}; }
  Memory& memory() const { return words_.memory(); }
  /// Allocates uninitialised trees, with uninitialised fractions if regions learn them.
  void reset(uint32_t bit_count, uint32_t regions, bool learns_fractions) {
    bit_count_ = bit_count;
    words_.reset(size_t{regions} * (bit_count / 32), kUninitialized);
    fractions_.reset(learns_fractions ? regions : 0, kUninitialized);
  }
  View<const float> fractions() const { return fractions_.view(); }
  View<float> mutable_fractions() { return fractions_.mutable_view(); }
  Quadtrees copy(Backend& backend) const;
  uint32_t size() const { return static_cast<uint32_t>(words_.size()) / (bit_count_ / 32); }
  uint32_t bit_count() const { return bit_count_; }
  size_t memory_bytes() const { return words_.memory_bytes() + fractions_.memory_bytes(); }
  /// Bytes of the trees, without spare memory.
  size_t data_bytes() const { return words_.size() * sizeof(words_.read()[0]); }
  void save(std::ostream& out) const {
    write_array(out, words_);
    write_array(out, fractions_);
  }
  /// Sets the stream's failbit and clears the trees unless all are quadtrees of bit_count() bits, and fractions are
  /// probabilities above zero.
  void load(std::istream& in);

 private:
  uint32_t bit_count_;
  Array<uint32_t> words_;
  Array<float> fractions_;  ///< by leaf slot, or empty
};

class DirectionalQuadtreePass final : public Pass {
 public:
  DirectionalQuadtreePass(const DirectionalQuadtreeSettings& settings, const OctreePass& octree, Memory& memory)
      : settings_(settings),
        octree_(octree),
        trees_(bit_count(), 0, memory),
        next_trees_(bit_count(), 0, memory),
        weights_(memory),
        next_weights_(memory),
        successors_(memory),
        moments_(memory),
        next_moments_(memory),
        moved_(memory) {
    directions_.kind = DirectionSamplerKind::quadtree;
  }

  void configure(const DirectionalQuadtreeSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "cdq", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return trees_.memory_bytes() + next_trees_.memory_bytes() + snapshot_.memory_bytes() + weights_.memory_bytes() +
           next_weights_.memory_bytes() + successors_.memory_bytes() + moments_.memory_bytes() +
           next_moments_.memory_bytes();
  }
  std::vector<PassStatistic> statistics() const override {
    return {{"migrations", static_cast<double>(moved_.read())},
            {"quadtree-bytes", static_cast<double>(trees_.data_bytes())},
            {"memory-bytes", static_cast<double>(weights_.size() * sizeof(QuadtreeWeights))}};
  }
  std::vector<PassRecords> records() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// The sampler for estimators; valid after the first run().
  const DirectionSampler& directions() const { return directions_; }

 private:
  /// Adapts the trees to the last frame's samples. Changes nothing if memory is missing.
  void take_in_samples(const FrameContext& frame);
  /// Creates the trees of the current octree's leaves: copies of their origins' if `keep`, else uniform ones.
  /// `remembers`: copies the weights, too. Allocates nothing.
  void populate(const FrameContext& frame, bool keep, bool remembers);
  /// Sets moments and fractions of the next trees, if regions learn fractions. Allocates nothing.
  void populate_fractions(const FrameContext& frame, bool keep);
  uint32_t bit_count() const { return 32 * (1 + static_cast<uint32_t>(settings_.bits)); }

  DirectionalQuadtreeSettings settings_;
  const OctreePass& octree_;
  DirectionSampler directions_;
  uint64_t generation_ = 0;  ///< generation of the octree whose regions have the trees
  Quadtrees trees_;
  Quadtrees next_trees_;  ///< buffer for the next octree, swapped with trees_
  Snapshot<Quadtrees> snapshot_;
  Array<QuadtreeWeights> weights_;       ///< weights by leaf slot; empty if none outlast a frame
  Array<QuadtreeWeights> next_weights_;  ///< buffer for the next octree, swapped with weights_
  Array<uint32_t> successors_;           ///< number of next regions, by origin
  Array<MixtureMoments> moments_;        ///< by leaf slot; empty unless regions learn fractions
  Array<MixtureMoments> next_moments_;   ///< buffer for the next octree, swapped with moments_
  KernelValue<uint64_t> moved_;          ///< number of migrations in the last frame
};

}  // namespace relume
