#include "render/display.h"

#include <cmath>

#include "framebuffer/auto_exposure.h"
#include "render/settings.h"

namespace relume {

Display fixed_display(const OutputSettings& settings) {
  const Display standard;
  return {settings.exposure.value_or(standard.exposure), settings.fixed_tone_map().value_or(standard.tone_map)};
}

Display display_for(const OutputSettings& settings, float metered, bool in_studio) {
  return {settings.exposure.value_or(metered),
          settings.fixed_tone_map().value_or(in_studio ? ToneMap::neutral : ToneMap::agx)};
}

Display display_for(const OutputSettings& settings, std::span<const Rgb> radiance, bool in_studio) {
  return display_for(settings, settings.exposure ? 0.0f : auto_exposure(radiance), in_studio);
}

float adapted_exposure(float previous, float metered, float seconds) {
  return lerp(metered, previous, std::pow(0.25f, seconds / 0.5f));
}

}  // namespace relume
