// Adapts the quadtrees of all regions.
#pragma once

#include "core/fixed_point.h"
#include "frame/group.h"
#include "techniques/guiding/directional_quadtree/adapt_quadtree_group.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Regions whose samples also adapt the tree of a region with few samples, as lists of lights are merged in
/// [Dittebrandt20, §4.1]: its face neighbours and the leaves of its parent.
struct QuadtreePool {
  View<const uint32_t> neighbours = {};  ///< six per region, or kNoRegion
  uint32_t samples = 0;                  ///< number from which a region uses its own samples only; 0: no pooling
  float guided_fraction = 0;             ///< share of directions from trees
};

/// The value of `stability` (QuadtreeAdaption) for trees that learn importance. Their sums are importance itself, not
/// its squares. With squares, a leaf of the importance F is split if stability · F² exceeds Σ f² over the four leaves
/// to join. For equal f = T / 4, that is 2 √stability · F > T. Above 1, leaves would move back and forth.
RELUME_HD inline float importance_stability(float stability) { return relume::min(2.0f * std::sqrt(stability), 1.0f); }

/// The samples that adapt one tree: its region's, then those of the pool. With n of N = QuadtreePool::samples samples,
/// squares from the pool count 1 − n / N.
struct PooledSamples {
  static constexpr uint32_t kMost = 14;  ///< the region, six neighbours, seven siblings
  uint32_t regions[kMost] = {};
  uint32_t ends[kMost] = {};  ///< number of samples up to the end of that region
  uint32_t count = 0;         ///< of regions
  float factor = 0;           ///< of values from the pool

  RELUME_HD PooledSamples(const SampleGroupsView& samples, const QuadtreePool& pool, uint32_t region) {
    add(samples, region);
    const uint32_t own = samples.counts[region];
    if (own >= pool.samples) return;
    factor = std::sqrt(1.0f - static_cast<float>(own) / static_cast<float>(pool.samples));
    for (uint32_t face = 0; face < 6; ++face) {
      const uint32_t neighbour = pool.neighbours[6 * region + face];
      if (neighbour != kNoRegion) add(samples, neighbour);
    }
    for (uint32_t sibling = region / 8 * 8; sibling < region / 8 * 8 + 8; ++sibling) add(samples, sibling);
  }

  RELUME_HD uint32_t size() const { return ends[count - 1]; }
  /// Number of the region that contains sample i.
  RELUME_HD uint32_t number_of(uint32_t i) const {
    uint32_t k = 0;
    while (i >= ends[k]) ++k;
    return k;
  }

 private:
  /// Adds a region once.
  RELUME_HD void add(const SampleGroupsView& samples, uint32_t region) {
    for (uint32_t k = 0; k < count; ++k) {
      if (regions[k] == region) return;
    }
    regions[count] = region;
    ends[count] = (count > 0 ? ends[count - 1] : 0u) + samples.counts[region];
    ++count;
  }
};

/// Adapts the quadtree of each region to the region's samples of radiance or importance, and to those of its pool; one
/// group per region.
struct AdaptQuadtreesKernel {
  static constexpr uint32_t kThreads = 128;
  using Shared = GroupAdaption;

  SampleGroupsView samples;
  QuadtreeArray trees;
  QuadtreeAdaption options;
  float guided_fraction = 0;      ///< share of directions from trees of an earlier frame; 0: samples are from `trees`
  View<QuadtreeWeights> weights;  ///< weights of the last frame by region; empty: no memory
  View<uint64_t> moved;           ///< number of migrations, one element
  View<const float> fractions = {};  ///< learned probability of the BSDF by region; empty: none
  QuadtreePool pool = {};
  bool importance = false;  ///< whether the trees learn importance

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const {
    const PooledSamples pooled(samples, pool, region);
    const uint32_t count = pooled.size();
    if (count == 0) return;
    const bool remembers = weights.size > 0;
    group.each(QuadtreeWeights::kBits, [&](uint32_t bit) {
      shared.weights.set(bit, 0);
      if (remembers) shared.weights.copy(bit, weights[region], bit);
    });
    DirectionalQuadtree tree = trees.load(region);
    const DirectionalQuadtree before = tree;
    const uint32_t migrations = shared.adapt(
        group, tree, [&](uint32_t i) { return sample(before, pooled, i); }, count, options);
    if (remembers)
      group.each(QuadtreeWeights::kBits, [&](uint32_t bit) { weights[region].copy(bit, shared.weights, bit); });
    if (migrations > 0) group.each(1, [&](uint32_t) { store(region, tree, migrations); });
  }

  void on_host(uint32_t region, uint32_t) const {
    const PooledSamples pooled(samples, pool, region);
    const uint32_t count = pooled.size();
    if (count == 0) return;
    DirectionalQuadtree tree = trees.load(region);
    const DirectionalQuadtree before = tree;
    QuadtreeWeights of_this_frame{};
    QuadtreeWeights& w = weights.size > 0 ? weights[region] : of_this_frame;
    const uint32_t migrations = adapt(
        tree, w, [&](uint32_t i) { return sample(before, pooled, i); }, count, options);
    if (migrations > 0) store(region, tree, migrations);
  }

 private:
  RELUME_HD void store(uint32_t region, const DirectionalQuadtree& tree, uint32_t migrations) const {
    trees.store(region, tree);
    atomic_add(&moved[0], uint64_t{migrations});
  }

  /// Sample i for the tree `before` of the first pooled region.
  RELUME_HD DirectionSample sample(const DirectionalQuadtree& before, const PooledSamples& pooled, uint32_t i) const {
    if (importance) return importance_sample(pooled, i);
    const uint32_t region = pooled.regions[0];
    if (i < pooled.ends[0]) {
      const VertexSample& s = samples.sample(region, i);
      return {s.direction, weighted_value(s) * value_scale(before, region, s, guided_fraction)};
    }
    const uint32_t k = pooled.number_of(i);
    const VertexSample& s = samples.sample(pooled.regions[k], i - pooled.ends[k - 1]);
    return {s.direction, weighted_value(s) * value_scale(before, region, s, pool.guided_fraction) * pooled.factor};
  }

  /// The same for importance. Its square is the importance that arrived: camera subpaths arrive in proportion to it,
  /// whatever the tree is.
  RELUME_HD DirectionSample importance_sample(const PooledSamples& pooled, uint32_t i) const {
    const uint32_t k = pooled.number_of(i);
    const uint32_t at = samples.address(pooled.regions[k], k == 0 ? i : i - pooled.ends[k - 1]);
    const ImportanceSample& s = samples.importance[at];
    const float value = std::sqrt(s.value * samples.samples[at].weight);
    return {s.direction, k == 0 ? value : value * pooled.factor};
  }

  /// The value whose square is that of the record times its weight.
  RELUME_HD static float weighted_value(const VertexSample& s) { return s.value * std::sqrt(s.weight); }

  /// Factor of a sample's value, 1 if the sampled tree is `tree` (`guided` 0). It multiplies the square by the ratio of
  /// the two mixture densities. In expectation, the sums of squares are then those of samples from `tree`. Records
  /// without the BSDF's density were sampled with the same fraction.
  RELUME_HD float value_scale(const DirectionalQuadtree& tree, uint32_t region, const VertexSample& s,
                              float guided) const {
    if (guided == 0.0f || !(s.value > 0.0f)) return 1.0f;
    constexpr float kLeastRatio = 0.02f;  // about the precision of packed densities
    const float pdf_w = unpack_density(s.densities);
    const float pdf_tree = tree.pdf(direction_from_square(unpack_square(s.direction)));
    if (region < fractions.size && s.bsdf != 0) {
      const float fraction = fractions[region];
      const float mixture = fraction * unpack_guide_density(s.bsdf) + (1.0f - fraction) * pdf_tree;
      return 1.0f / std::sqrt(relume::max(mixture / pdf_w, kLeastRatio));
    }
    const float change = pdf_tree - unpack_guide_density(s.densities);
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
