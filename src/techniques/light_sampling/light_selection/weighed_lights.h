// Lights and their importance at a point, on the stack between a choice and its probability.
#pragma once

#include "lights/light_importance.h"
#include "scene/surface_point.h"

namespace relume {

/// Maximum number of lights weighed at a point.
inline constexpr uint32_t kMaxWeighedLights = 64;

struct WeighedLights {
  // Zeroing half a kilobyte would cost more than most look-ups. The first is initialised, or compilers warn.
  LightId ids[kMaxWeighedLights];
  float weights[kMaxWeighedLights];
  uint32_t count = 0;
  float sum = 0;  ///< of the weights; above 0 after weigh()

  RELUME_HD WeighedLights() { ids[0] = kNoLight; }

  RELUME_HD bool weighed() const { return sum > 0.0f; }

  /// Index of `light`, or `count`.
  RELUME_HD uint32_t find(LightId light) const {
    uint32_t place = 0;
    while (place < count && ids[place] != light) ++place;
    return place;
  }

  /// Computes the weights of `ids`; equal weights if their sum is zero or overflows.
  RELUME_HD void weigh(const SurfacePoint& sp, const LtcTable& ltc, const LightsView& lights,
                       const View<const CompactLight>& compact) {
    const LightReceiver receiver = make_light_receiver(ltc, sp.position, sp.frame, sp.wo_local, sp.bsdf);
    sum = light_importances(receiver, lights, compact, ids, count, weights);
    if (sum > 0.0f && is_finite(sum)) return;
    for (uint32_t i = 0; i < count; ++i) weights[i] = 1.0f;
    sum = static_cast<float>(count);
  }
};

}  // namespace relume
