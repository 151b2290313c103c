// A tone map or OpenColorIO view as a table, which the graphics card applies to every pixel.
#pragma once

#include <vector>

#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume {
class OcioView;
}  // namespace relume

namespace relume::viewer {

/// Range of the table: log2 of exposed radiance. Radiance beyond it is clamped.
inline constexpr float kTableMinEv = -12;
inline constexpr float kTableMaxEv = 8;

/// Display-encoded colours in [0, 1], red fastest. Entries of a channel are at equal steps of log2, except that the
/// first one is at radiance 0. Values between entries are interpolated linearly.
struct DisplayTable {
  int size = 0;  ///< entries per channel
  std::vector<Rgb> colors;
};

/// Interpolated colours differ from tone_map()'s by less than half a step of 255 on average.
DisplayTable display_table(ToneMap tone_map);

/// The same for a view, computed on all cores. Finer, because views may clip sharply: there they differ by more.
DisplayTable display_table(const OcioView& view);

}  // namespace relume::viewer
