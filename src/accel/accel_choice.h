// The acceleration structures that can answer ray queries.
#pragma once

#include "core/denormals.h"

namespace relume {

enum class AccelChoice : int {
  embree,
  bvh,  ///< relume's own (accel/bvh)
};

/// Mode of kernels whose rays the structure answers. Devices keep denormals, so that --accel bvh gives their bits.
constexpr Denormals denormals_with(AccelChoice accel) {
  return accel == AccelChoice::embree ? Denormals::flush : Denormals::keep;
}

}  // namespace relume
