// Samples of many lights at once, on the host.
#pragma once

#include "lights/light.h"

namespace relume {

/// Arguments of sample_li().
struct LightRequest {
  LightId light = kNoLight;
  Vec3 position{0};
  Vec2 u{0};
  float time = kShutterMiddle;
};

/// Sets samples[i] to sample_li() of requests[i], with the same bits. Eight lights of one shape are sampled side by
/// side.
void sample_lights(const LightsView& view, View<const LightRequest> requests, LightSample* samples);

}  // namespace relume
