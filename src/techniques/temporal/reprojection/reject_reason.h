// Why reprojection rejects the history of a pixel.
#pragma once

#include <cstdint>

namespace relume {

/// Of the pixels of the previous frame (forward: `history-reject-reason`), and of those of this frame
/// (`history-reason`). The numbers are what the buffers show.
enum class RejectReason : uint32_t {
  empty,           ///< no history, or the background; of this frame: no history moved here
  none,            ///< the history is kept
  off_screen,      ///< the surface has left the image; backward: was outside of the image
  occluded,        ///< another surface is in front of it
  view_dependent,  ///< eq. 15: the reflection differs too much in this direction
  near_specular,   ///< a mirror, or glass
  mixed,           ///< the pixel shows several surfaces
  relit,           ///< its lighting has changed
  covered,         ///< lost the depth test
  other_surface,   ///< backward: the previous pixel shows another surface; forward: this pixel does
  filled,          ///< forward: no history moved here, so the pixel looked back for one
};

/// The source of a pixel's history is a pixel of the previous frame, or this: none.
inline constexpr uint32_t kNoSource = 0xffffffffu;

}  // namespace relume
