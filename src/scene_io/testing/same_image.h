// Compares the renderings of a scene and of its copy in another format.
#pragma once

#include "relume/scene.h"

namespace relume::testing {

/// Expects that the means of 4 × 4 blocks of small renderings differ by noise and by the rounding of 8-bit textures.
void expect_same_image(const Scene& expected, const Scene& found);

}  // namespace relume::testing
