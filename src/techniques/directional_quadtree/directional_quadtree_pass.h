// The direction sampling "cdq" as a pass, behind the octree's.
#pragma once

#include "pipeline/pass.h"
#include "techniques/direction_sampling/direction_sampler.h"
#include "techniques/directional_quadtree/adapt_quadtrees.h"
#include "techniques/directional_quadtree/settings.h"
#include "techniques/octree/octree_pass.h"

namespace relume {

/// Whether the bits are a tree: as many inner nodes as there are groups of children, each ahead of its children, none
/// deeper than leaves are split. All that pathways through a tree rely on.
bool is_quadtree(const DirectionalQuadtree& tree);

class DirectionalQuadtreePass final : public Pass {
 public:
  DirectionalQuadtreePass(const DirectionalQuadtreeSettings& settings, const OctreePass& octree)
      : settings_(settings), octree_(octree) {
    directions_.kind = DirectionSamplerKind::quadtree;
  }

  PassDeclaration declaration() const override { return {.name = "cdq", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  bool adapts() const override { return true; }
  size_t memory_bytes() const override {
    return words_.size() * sizeof(uint32_t) + weights_.size() * sizeof(QuadtreeWeights);
  }
  std::vector<PassFigure> figures() const override {
    return {{"migrations", static_cast<double>(moved_)},
            {"quadtree-bytes", static_cast<double>(words_.size() * sizeof(uint32_t))},
            {"memory-bytes", static_cast<double>(weights_.size() * sizeof(QuadtreeWeights))}};
  }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// What estimators sample with; valid from the first run() on.
  const DirectionSampler& directions() const { return directions_; }

 private:
  /// Trees for the leaves of the present octree: those that they stem from if `keep`, else uniform ones.
  void populate(uint32_t bit_count, bool keep);

  const DirectionalQuadtreeSettings& settings_;
  const OctreePass& octree_;
  DirectionSampler directions_;
  std::vector<uint32_t> words_;
  std::vector<QuadtreeWeights> weights_;  ///< by leaf slot; empty without `cdq.memory`
  uint64_t moved_ = 0;                    ///< leaves, in the last frame
};

}  // namespace relume
