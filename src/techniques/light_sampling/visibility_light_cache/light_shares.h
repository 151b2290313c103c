// What a region learns from the outcomes of its shadow rays.
#pragma once

#include "techniques/light_sampling/light_selection/weighed_lights.h"

namespace relume {

/// Expected visibility of lights at infinity. The last element is that of all further ones.
struct InfinityVisibility {
  static constexpr uint32_t kCount = 4;
  float of[kCount] = {1, 1, 1, 1};

  RELUME_HD static uint32_t index_of(uint32_t infinite_light) { return relume::min(infinite_light, kCount - 1); }
};

struct LightShares {
  InfinityVisibility visibility = {{0.5f, 0.5f, 0.5f, 0.5f}};  ///< > 0, at most 1
  float exploration = 0.1f;                                    ///< > 0, at most 1

  bool valid() const {
    for (const float visible : visibility.of)
      if (!(visible > 0.0f && visible <= 1.0f)) return false;
    return exploration > 0.0f && exploration <= 1.0f;
  }
};

}  // namespace relume
