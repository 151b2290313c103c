// Decides whether to rebuild or refit the BVH of a deforming mesh.
#pragma once

#include <vector>

#include "accel/accel_structure.h"
#include "core/box.h"

namespace relume {

/// Measures clusters of triangles that were neighbours when the BVH was built, like those below its lower nodes. By the
/// surface area heuristic ([MacDonald90]), the probability that a ray hits a node is proportional to the area of its
/// box. Once the clusters' boxes have grown relative to the mesh's box, a rebuild saves more time than it costs.
class RefitCost {
 public:
  /// Starts from the BVH of the mesh's current state. Does nothing for meshes that do not deform.
  explicit RefitCost(const AccelMesh& mesh);

  /// Whether the BVH should be rebuilt.
  bool has_grown(const AccelMesh& mesh) const;
  /// Call after the BVH has been rebuilt for the mesh's current state.
  void reset(const AccelMesh& mesh);

 private:
  /// Sum of the areas of the clusters' boxes, relative to the area of the mesh's box.
  float cost(const AccelMesh& mesh) const;

  std::vector<uint32_t> order_;  ///< triangles in the order of their clusters
  float built_cost_ = 0;
};

}  // namespace relume
