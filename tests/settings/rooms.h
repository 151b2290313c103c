// Scenes for the settings to act on.
#pragma once

#include "scene/scene.h"

namespace relume::support {

/// A room, open to sun and sky, that holds something for every technique: many lamps of which partitions hide some,
/// rough and polished metal, gloss, a mirror, a texture, a second camera called "side", and a lamp that moves during
/// the first second.
Scene build_busy_room();

/// A light that fills the image evenly, whatever the random numbers, and is gone after a second.
Scene build_curtain();

/// The same in the clip "go"; in the first one, "stay", it stays.
Scene build_curtain_with_clips();

}  // namespace relume::support
