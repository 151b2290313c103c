// A tone map or OpenColorIO view as a lookup table, applied to every pixel on the GPU.
#pragma once

#include <vector>

#include "core/vec.h"
#include "relume/tone_map.h"

namespace relume {
class OcioView;
}  // namespace relume

namespace relume::viewer {

/// Range of the table, to which radiance is clamped: log2 of exposed radiance.
inline constexpr float kTableMinEv = -12;
inline constexpr float kTableMaxEv = 8;

/// Display-encoded colours in [0, 1], red fastest. Entries per channel are at equal steps of log2, except that the
/// first is at radiance 0. Values between entries are interpolated linearly.
struct DisplayTable {
  int size = 0;  ///< entries per channel
  std::vector<Rgb> colors;
};

/// Interpolated colours differ from tone_map()'s by less than 0.5/255 on average.
DisplayTable display_table(ToneMap tone_map);

/// The same for a view, computed on all cores, at a higher resolution. Views may clip sharply, where the difference is
/// larger.
DisplayTable display_table(const OcioView& view);

}  // namespace relume::viewer
