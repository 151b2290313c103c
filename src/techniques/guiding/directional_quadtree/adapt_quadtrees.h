// Adapts the quadtrees of all regions.
#pragma once

#include "core/fixed_point.h"
#include "frame/group.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtree_group.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Adapts the quadtree of each region to the region's samples; one group per region.
struct AdaptQuadtreesKernel {
  static constexpr uint32_t kThreads = 128;
  using Shared = GroupAdaption;

  SampleGroupsView samples;
  QuadtreeArray trees;
  QuadtreeAdaption options;
  float guided_fraction = 0;         ///< share of directions from trees of an earlier frame; 0: samples are from `trees`
  View<QuadtreeWeights> weights;     ///< weights of the last frame by region; empty: no memory
  View<uint64_t> moved;              ///< number of migrations, one element
  View<const float> fractions = {};  ///< learned probability of the BSDF by region; empty: none

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const {
    const uint32_t count = samples.counts[region];
    if (count == 0) return;
    const bool remembers = weights.size > 0;
    group.each(QuadtreeWeights::kBits, [&](uint32_t bit) {
      shared.weights.set(bit, 0);
      if (remembers) shared.weights.copy(bit, weights[region], bit);
    });
    DirectionalQuadtree tree = trees.load(region);
    const DirectionalQuadtree before = tree;
    const uint32_t migrations = shared.adapt(
        group, tree, [&](uint32_t i) { return sample(before, region, i); }, count, options);
    if (remembers)
      group.each(QuadtreeWeights::kBits, [&](uint32_t bit) { weights[region].copy(bit, shared.weights, bit); });
    if (migrations > 0) group.each(1, [&](uint32_t) { store(region, tree, migrations); });
  }

  void on_host(uint32_t region, uint32_t) const {
    const uint32_t count = samples.counts[region];
    if (count == 0) return;
    DirectionalQuadtree tree = trees.load(region);
    const DirectionalQuadtree before = tree;
    QuadtreeWeights of_this_frame{};
    QuadtreeWeights& w = weights.size > 0 ? weights[region] : of_this_frame;
    const uint32_t migrations = adapt(
        tree, w, [&](uint32_t i) { return sample(before, region, i); }, count, options);
    if (migrations > 0) store(region, tree, migrations);
  }

 private:
  RELUME_HD void store(uint32_t region, const DirectionalQuadtree& tree, uint32_t migrations) const {
    trees.store(region, tree);
    atomic_add(&moved[0], uint64_t{migrations});
  }

  /// Sample i of a region with the tree `before`.
  RELUME_HD DirectionSample sample(const DirectionalQuadtree& before, uint32_t region, uint32_t i) const {
    const VertexSample& s = samples.sample(region, i);
    return {s.direction, s.value * value_scale(before, region, s)};
  }

  /// Factor of a sample's value. It multiplies the square by the ratio of the two mixture densities. In expectation,
  /// the sums of squares are then those of samples from `tree`.
  RELUME_HD float value_scale(const DirectionalQuadtree& tree, uint32_t region, const VertexSample& s) const {
    if (guided_fraction == 0.0f || !(s.value > 0.0f)) return 1.0f;
    constexpr float kLeastRatio = 0.02f;  // about the precision of packed densities
    const float pdf_w = unpack_density(s.densities);
    const float change =
        tree.pdf(direction_from_square(unpack_square(s.direction))) - unpack_guide_density(s.densities);
    const float guided = region < fractions.size ? 1.0f - fractions[region] : guided_fraction;
    return 1.0f / std::sqrt(relume::max(1.0f + guided * change / pdf_w, kLeastRatio));
  }
};

/// Gives each region the quadtree of its origin, or a uniform one.
struct PopulateQuadtreesKernel {
  View<const uint32_t> previous;  ///< origin by region
  QuadtreeArray trees;            ///< those of the origins; empty: all new trees are uniform
  QuadtreeArray next;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const bool keep = !trees.words.empty() && previous[region] != kNoRegion;
    next.store(region, keep ? trees.load(previous[region]) : uniform_quadtree(next.bit_count));
  }
};

/// Counts the regions of each origin.
struct CountSuccessorsKernel {
  View<const uint32_t> previous;  ///< origin by region
  View<uint32_t> successors;      ///< by origin; zero before

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    if (previous[region] != kNoRegion) atomic_add(&successors[previous[region]], 1u);
  }
};

/// Gives each region the weights of its origin. Each part of a split region has a quarter, because a surface passes
/// through about four of eight parts.
struct InheritWeightsKernel {
  View<const uint32_t> previous;        ///< origin by region
  View<const uint32_t> successors;      ///< number of regions with this origin
  View<const QuadtreeWeights> weights;  ///< by origin; empty: new ones are zero
  View<QuadtreeWeights> next;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t from = previous[region];
    if (weights.empty() || from == kNoRegion) {
      next[region] = {};
      return;
    }
    next[region] = weights[from];
    if (successors[from] > 1) next[region].scale(0.25f);
  }
};

}  // namespace relume
