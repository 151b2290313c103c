// Conversion of a frame's values to colours, on the GPU or the processor.
#pragma once

#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume::viewer {

struct DisplayTable;

/// Conversion of values to colours.
enum class DisplayMode : int {
  radiance,     ///< exposure and tone map
  color,        ///< the range maps to 0 … 1, gamma-encoded
  false_color,  ///< one channel or the magnitude, through a palette
  direction,    ///< components map from [-1, 1] to 0 … 1
};

struct DisplayTransform {
  DisplayMode mode = DisplayMode::radiance;
  ToneMap tone_map = ToneMap::agx;
  const DisplayTable* table = nullptr;  ///< replaces `tone_map`, which must then stay the same; nullptr: none
  float exposure = 0;                   ///< stops
  Vec2 range{0, 1};
  int channel = 0;  ///< for false_color; -1: length of the vector
  bool operator==(const DisplayTransform&) const = default;
};

/// Palette of false_color at t in [0, 1]: dark to bright with rising luminance ([Green11], start 0.5, -1.5 rotations,
/// saturation 1). Display-encoded.
Rgb palette_color(float t);

}  // namespace relume::viewer
