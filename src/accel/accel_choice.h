// The acceleration structures that can answer ray queries.
#pragma once

#include "core/denormals.h"

namespace relume {

enum class AccelChoice : int {
  embree,
  bvh,  ///< relume's own (accel/bvh)
};

/// Denormal mode of kernels that trace rays with the structure. relume's BVH keeps denormals, as devices do, for equal
/// bits.
constexpr Denormals denormals_with(AccelChoice accel) {
  return accel == AccelChoice::embree ? Denormals::flush : Denormals::keep;
}

}  // namespace relume
