// Adapts the quadtrees of all regions.
#pragma once

#include "core/fixed_point.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtree.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Adapts the quadtree of each region to the region's samples.
struct AdaptQuadtreesKernel {
  SampleGroupsView samples;
  QuadtreeArray trees;
  QuadtreeAdaption options;
  float guided_fraction = 0;      ///< of directions, from trees of an earlier frame; 0: from `trees`
  View<QuadtreeWeights> weights;  ///< by region, from the frame before; empty: nothing is remembered
  View<uint64_t> moved;           ///< one: leaves that changed their place

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t count = samples.counts[region];
    if (count == 0) return;
    DirectionalQuadtree tree = trees.load(region);
    const DirectionalQuadtree before = tree;
    const auto sample = [&](uint32_t i) {
      const VertexSample& s = samples.sample(region, i);
      return DirectionSample{s.direction, s.value * value_scale(before, s)};
    };
    QuadtreeWeights of_this_frame;
    QuadtreeWeights& w = weights.size > 0 ? weights[region] : of_this_frame;
    const uint32_t migrations = adapt(tree, w, sample, count, options);
    if (migrations == 0) return;
    trees.store(region, tree);
    atomic_add(&moved[0], uint64_t{migrations});
  }

 private:
  /// Sums of squares that samples from other trees leave are those that samples from `tree` would leave, in the mean,
  /// if each square is multiplied by the ratio of the densities.
  RELUME_HD float value_scale(const DirectionalQuadtree& tree, const VertexSample& s) const {
    if (guided_fraction == 0.0f || !(s.value > 0.0f)) return 1.0f;
    constexpr float kLeastRatio = 0.02f;  // about what the precision of the densities allows
    const float pdf_w = unpack_density(s.densities);
    const float change =
        tree.pdf(direction_from_square(unpack_square(s.direction))) - unpack_guide_density(s.densities);
    return 1.0f / std::sqrt(relume::max(1.0f + guided_fraction * change / pdf_w, kLeastRatio));
  }
};

}  // namespace relume
