// Computes the compact forms of lights in a launch.
#pragma once

#include "frame/launch.h"
#include "lights/light_importance.h"

namespace relume {

struct CompactLightsKernel {
  LightsView lights;
  View<CompactLight> compact;  ///< by light

  RELUME_HD void operator()(uint32_t light, uint32_t) const {
    compact[light] = compact_form(lights, lights.lights[light]);
  }
};

/// Replaces `compact` by the compact forms of the first `count` lights.
inline void write_compact_lights(Backend& backend, std::string_view name, const LightsView& lights, uint32_t count,
                                 Array<CompactLight>& compact) {
  compact.reset(count, kUninitialized);
  launch(backend, name, CompactLightsKernel{lights, compact.mutable_view()}, count, 1);
}

}  // namespace relume
