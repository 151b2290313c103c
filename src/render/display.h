// Display settings of an image, with automatic values resolved.
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

/// Equal for all images, so that they are comparable: automatic values are Display's defaults.
Display fixed_display(const OutputSettings& settings);

/// For one image: an automatic exposure is `metered`; an automatic tone map is `neutral` under the studio, otherwise
/// `agx`.
Display display_for(const OutputSettings& settings, float metered, bool in_studio);
/// The same, metered by auto_exposure() if needed.
Display display_for(const OutputSettings& settings, std::span<const Rgb> radiance, bool in_studio);

/// Exposure of the next image of a sequence. Moves three quarters from `previous` to `metered` in half a second.
float adapted_exposure(float previous, float metered, float seconds);

}  // namespace relume
