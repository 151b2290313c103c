// Scenes for tests of settings.
#pragma once

#include "scene/scene.h"

namespace relume::support {

/// A room with sun and sky for every technique: many lamps, some behind partitions, rough and polished metal, gloss, a
/// mirror, a texture, visible sets, a second camera called "side", and a lamp that moves during the first second.
Scene build_busy_room();

/// A light that fills the image uniformly, independent of random numbers, and vanishes after a second.
Scene build_curtain();

/// Same in the clip "go"; in the first clip, "stay", it remains.
Scene build_curtain_with_clips();

}  // namespace relume::support
