// Quadtrees of random shape with random fractions of the BSDF, in the regions of an octree over a scene.
#pragma once

#include <vector>

#include "techniques/spatial/octree/octree_tree.h"
#include "techniques/transport/bdpt/bdpt_context.h"

namespace relume::testing {

class RandomGuides {
 public:
  RandomGuides(Backend& backend, const SceneView& scene);

  /// Lets the quadtrees guide the camera subpaths of `c`, and makes the octree that of its records. `jitter`: of
  /// PathRecording.
  void guide(LearningContext& c, float jitter = 0);
  /// After guide(): also lets quadtrees of other shapes guide the light subpaths.
  void guide_light_subpaths(LearningContext& c);

  const OctreeTree& tree() const { return tree_; }

 private:
  OctreeTree tree_;
  std::vector<uint32_t> words_;
  std::vector<uint32_t> importance_;  ///< as words_, for light subpaths
  std::vector<float> fractions_;
};

}  // namespace relume::testing
