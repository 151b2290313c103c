// The acceleration structures that can answer ray queries.
#pragma once

namespace relume {

enum class AccelChoice : int {
  embree,
  bvh,  ///< relume's own (accel/bvh)
};

}  // namespace relume
