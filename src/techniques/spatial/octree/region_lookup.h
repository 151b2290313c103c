// Look-up of the regions from which vertices of paths take estimates.
#pragma once

#include "core/hash.h"
#include "scene/surface_point.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

struct RegionLookup {
  OctreeView tree;
  float jitter = 0;   ///< width of the jitter, in edges of leaves
  uint32_t seed = 0;  ///< of the jitter, different in each frame

  /// The region of a vertex, with a jitter that depends on the place and the frame only: subpaths from both sides find
  /// the same region at a vertex of their path.
  RELUME_HD uint32_t region_at(const SurfacePoint& sp) const {
    return jitter > 0.0f ? jittered_region(sp) : tree.find(sp.previous_position);
  }
  RELUME_HD uint32_t jittered_region(const SurfacePoint& sp) const {
    const UVec3 q = tree.quantise(sp.previous_position);
    return tree.find_near(q, jitter, random_vector(hash(hash(seed, q.x), q.y, q.z)));
  }

  /// Three independent numbers in [0, 1).
  RELUME_HD static Vec3 random_vector(uint32_t h) {
    return {to_unit_float(h), to_unit_float(hash(h, 1u)), to_unit_float(hash(h, 2u))};
  }
};

}  // namespace relume
