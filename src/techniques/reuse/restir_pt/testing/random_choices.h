// Learned structures with random content, for tests of candidates whose choices learn.
#pragma once

#include <vector>

#include "techniques/guiding/directional_quadtree/testing/random_tree.h"
#include "techniques/reuse/restir_pt/learned_choices.h"
#include "techniques/spatial/octree/octree_tree.h"

namespace relume::testing {

/// A random quadtree for each of eight regions around the origin, and records of paths.
struct RandomChoices {
  static constexpr uint32_t kVertices = 2;

  explicit RandomChoices(uint32_t pixels) : samples(size_t{kVertices} * pixels), words(size_t{4} * tree.leaf_slots()) {
    directions.kind = DirectionSamplerKind::quadtree;
    directions.quadtrees = {mutable_view_of(words), 128};
    for (uint32_t region = 0; region < tree.leaf_slots(); ++region)
      directions.quadtrees.store(region, random_tree(128, 5 + region));
    directions.bsdf_fraction = 0.3f;
    learning.samples = {.octree = tree.view(), .lookup = {.tree = tree.view()}, .samples = mutable_view_of(samples)};
    learning.samples.vertices = kVertices;
    learning.samples.pixels = pixels;
    learning.records_samples = true;
  }
  RandomChoices(const RandomChoices&) = delete;  // views refer to the object
  RandomChoices& operator=(const RandomChoices&) = delete;

  OctreeTree tree{Vec3(0, 2, 0), 16};
  std::vector<VertexSample> samples;
  std::vector<uint32_t> words;
  DirectionSampler directions;
  LearnedChoices learning;
};

}  // namespace relume::testing
