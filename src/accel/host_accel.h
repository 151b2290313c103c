// Data that only ray queries on the host read.
#pragma once

#include "accel/accel_structure.h"

namespace relume {

/// Owned by an acceleration structure. Keeps its address while the structure exists.
struct HostAccelData {
  void* embree_scene = nullptr;              ///< RTCScene; null: relume's own BVH
  const AccelMesh* meshes = nullptr;         ///< of Embree's scene
  const AccelInstance* instances = nullptr;  ///< of Embree's scene
  OpacityFunction opacity;                   ///< of the surfaces in relume's own BVH
};

}  // namespace relume
