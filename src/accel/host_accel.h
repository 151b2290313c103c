// Data that ray queries on the host need besides the arrays of kernels.
#pragma once

#include "accel/accel_structure.h"

namespace relume {

/// Belongs to an acceleration structure. Its address stays the same as long as the structure exists.
struct HostAccelData {
  void* embree_scene = nullptr;              ///< RTCScene; null: relume's own BVH
  const AccelMesh* meshes = nullptr;         ///< of Embree's scene
  const AccelInstance* instances = nullptr;  ///< of Embree's scene
  OpacityFunction opacity;                   ///< of the surfaces in relume's own BVH
};

}  // namespace relume
