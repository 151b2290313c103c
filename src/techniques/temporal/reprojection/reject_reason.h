// Why reprojection rejects the history of a pixel.
#pragma once

#include <cstdint>

#include "core/hd.h"

namespace relume {

/// Numbers in two buffers. `history-reject-reason` has a reason for each pixel of the previous frame (forward
/// reprojection only), `history-reason` one for each pixel of this frame.
enum class RejectReason : uint32_t {
  empty,           ///< no history, or the background; in this frame: no history moved here
  none,            ///< the history is kept
  off_screen,      ///< the surface has left the image; backward: was outside the image
  occluded,        ///< another surface is in front of it
  view_dependent,  ///< eq. 15: the reflection in this direction differs too much
  near_specular,   ///< a mirror or glass
  mixed,           ///< the pixel shows several surfaces
  relit,           ///< the light has changed
  covered,         ///< lost the depth test
  other_surface,   ///< backward: the previous pixel shows another surface; forward: this pixel does
  filled,          ///< forward: no history moved here, and the pixel looked back
  looked_up,       ///< forward: kept, except the light of a cache's cells, which this frame looks up
};

/// Whether the history moves to this frame's pixels, with or without the light of cells.
RELUME_HD constexpr bool is_kept(RejectReason reason) {
  return reason == RejectReason::none || reason == RejectReason::looked_up;
}

/// Value in place of a source pixel in the previous frame: no source.
inline constexpr uint32_t kNoSource = 0xffffffffu;

}  // namespace relume
