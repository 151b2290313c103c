// Why pixels keep what earlier frames have gathered, or do not.
#pragma once

#include <cstdint>

namespace relume {

/// Of a pixel of the frame before (forward: `history-fate`), and of one of this frame (`history-reason`). The numbers
/// are what the buffers show.
enum class ReprojectionFate : uint32_t {
  empty,           ///< it held nothing, or the background; of this frame: nothing came to lie here
  kept,            ///< a pixel of this frame goes on with it
  off_screen,      ///< its surface is not in the picture any more; backward: was not in the picture before
  occluded,        ///< something is in front of it now
  view_dependent,  ///< eq. 15: it would look too different from here
  near_specular,   ///< a mirror, or glass
  mixed,           ///< it saw more than one surface
  relit,           ///< its light has moved, or is hidden now, or was and is not
  covered,         ///< another one that is nearer, or came first, took its place
  other_surface,   ///< backward: another surface was seen where this one was; forward: what came lies on another one
  filled,          ///< forward: no history came that fits, so the pixel looked back for one
};

/// Where a pixel's content comes from: the index of a pixel of the frame before, or this.
inline constexpr uint32_t kNoSource = 0xffffffffu;

}  // namespace relume
