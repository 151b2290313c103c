// Decides when to rebuild the BVH of a deforming mesh instead of refitting it.
#pragma once

#include <vector>

#include "accel/embree_accel.h"
#include "core/box.h"

namespace relume {

/// Watches clusters of triangles that were neighbours when the BVH was built, as below its lower nodes. By the surface
/// area heuristic ([MacDonald90]) a ray meets a node in proportion to the area of its box. Once the boxes of the
/// clusters have grown, relative to that of the mesh, a new BVH saves more than it takes to build.
class RefitCost {
 public:
  /// For the BVH of the mesh as it is now. Does nothing for meshes that do not deform.
  explicit RefitCost(const AccelMesh& mesh);

  /// Whether the BVH should be rebuilt.
  bool has_grown(const AccelMesh& mesh) const;
  /// The BVH has been rebuilt for the mesh as it is now.
  void reset(const AccelMesh& mesh);

 private:
  /// Sum of the areas of the clusters' boxes over the area of the mesh's box.
  float cost(const AccelMesh& mesh) const;

  std::vector<uint32_t> order_;  ///< triangles, cluster after cluster
  float built_cost_ = 0;
};

}  // namespace relume
