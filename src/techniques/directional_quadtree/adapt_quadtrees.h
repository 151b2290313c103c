// Adapts the quadtrees of all regions.
#pragma once

#include "core/fixed_point.h"
#include "techniques/directional_quadtree/adapt_quadtree.h"
#include "techniques/octree/sample_stream.h"

namespace relume {

/// Adapts the quadtree of each region to the region's samples.
struct AdaptQuadtreesKernel {
  SampleGroupsView samples;
  QuadtreeArray trees;
  QuadtreeAdaption options;
  View<QuadtreeWeights> weights;  ///< by region, from the frame before; empty: nothing is remembered
  View<uint64_t> moved;           ///< one: leaves that changed their place

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t count = samples.counts[region];
    if (count == 0) return;
    DirectionalQuadtree tree = trees.load(region);
    const auto sample = [&](uint32_t i) {
      const VertexSample& s = samples.sample(region, i);
      return DirectionSample{s.direction, s.value};
    };
    QuadtreeWeights of_this_frame;
    QuadtreeWeights& w = weights.size > 0 ? weights[region] : of_this_frame;
    const uint32_t migrations = adapt(tree, w, sample, count, options);
    if (migrations == 0) return;
    trees.store(region, tree);
    atomic_add(&moved[0], uint64_t{migrations});
  }
};

}  // namespace relume
