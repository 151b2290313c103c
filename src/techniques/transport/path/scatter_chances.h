// Probabilities with which paths continue from their primary hits, where a radiance cache decides it.
#pragma once

#include "framebuffer/buffer_key.h"

namespace relume {

/// Probability, given its primary hit, with which the path of each pixel samples a direction there. Exists if a cache
/// modifies paths. Their directions then come from lobes whose colours the cache has raised (Demodulation).
inline constexpr BufferKey<float> kScatterChances{"scatter-chances"};

}  // namespace relume
