// How an image is shown: the display settings, with automatic values decided.
#pragma once

#include <span>

#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume {

struct OutputSettings;

struct Display {
  float exposure = 0;  ///< stops
  ToneMap tone_map = ToneMap::agx;

  friend bool operator==(const Display&, const Display&) = default;
};

/// The same for every image, so that images can be compared: automatic values are those of Display.
Display fixed_display(const OutputSettings& settings);

/// For one image: an automatic exposure is `metered`; an automatic tone map is `neutral` under the studio and `agx`
/// elsewhere.
Display display_for(const OutputSettings& settings, float metered, bool in_studio);
/// The same, metered by auto_exposure() if that is needed.
Display display_for(const OutputSettings& settings, std::span<const Rgb> radiance, bool in_studio);

/// Exposure of the next image of a sequence: three quarters of the way from `previous` to `metered` in half a second.
float adapted_exposure(float previous, float metered, float seconds);

}  // namespace relume
