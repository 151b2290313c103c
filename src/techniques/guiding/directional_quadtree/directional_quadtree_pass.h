// The direction sampling "cdq" as a pass, which runs after the octree's.
#pragma once

#include "frame/pass.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/guiding/directional_quadtree/learned_quadtrees.h"
#include "techniques/guiding/directional_quadtree/mixture_fraction.h"
#include "techniques/guiding/directional_quadtree/settings.h"
#include "techniques/spatial/octree/octree_pass.h"

namespace relume {

class DirectionalQuadtreePass final : public Pass {
 public:
  DirectionalQuadtreePass(const DirectionalQuadtreeSettings& settings, const OctreePass& octree, Memory& memory)
      : settings_(settings),
        octree_(octree),
        radiance_(bit_count(), memory),
        importance_(bit_count(), memory),
        moments_(memory),
        next_moments_(memory) {
    directions_.kind = DirectionSamplerKind::quadtree;
  }

  void configure(const DirectionalQuadtreeSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "cdq", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return radiance_.memory_bytes() + importance_.memory_bytes() + moments_.memory_bytes() +
           next_moments_.memory_bytes();
  }
  std::vector<PassStatistic> statistics() const override;
  std::vector<PassRecords> records() const override;
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

  /// The sampler for estimators; valid after the first run().
  const DirectionSampler& directions() const { return directions_; }

 private:
  /// Adapts the trees to the last frame's samples. Changes nothing if memory is missing.
  void take_in_samples(const FrameContext& frame);
  /// Adapts the trees of radiance, and the moments. `frozen`: whether the samples were drawn from other trees than
  /// those that they adapt. `remembers`: whether sums outlast the frame. Allocates nothing.
  void adapt_radiance(const FrameContext& frame, bool frozen, bool remembers);
  /// The same for the trees of importance.
  void adapt_importance(const FrameContext& frame, bool frozen, bool remembers);
  /// How trees adapt to samples of radiance.
  QuadtreeAdaption adaption(bool frozen) const;
  QuadtreePool pool() const;
  /// Sets moments and fractions of the next trees, if regions learn fractions. `keep`: whether those of the last trees
  /// are valid. Allocates nothing.
  void populate_fractions(const FrameContext& frame, bool keep);
  uint32_t bit_count() const { return 32 * (1 + static_cast<uint32_t>(settings_.bits)); }

  DirectionalQuadtreeSettings settings_;
  const OctreePass& octree_;
  DirectionSampler directions_;
  uint64_t generation_ = 0;  ///< generation of the octree whose regions have the trees
  LearnedQuadtrees radiance_;
  LearnedQuadtrees importance_;         ///< for light subpaths; empty unless camera subpaths record importance
  Array<MixtureMoments> moments_;       ///< by leaf slot; empty unless regions learn fractions
  Array<MixtureMoments> next_moments_;  ///< buffer for the next octree, swapped with moments_
};

}  // namespace relume
