// Arbitrary output variables: planes derived from the buffers.
#pragma once

#include <string>
#include <vector>

#include "frame/pass.h"
#include "framebuffer/buffer_table.h"
#include "relume/aov.h"
#include "relume/image_io.h"

namespace relume {

/// "variance" and every displayed buffer of these passes, by name.
std::vector<AovLayer> aov_layers(const std::vector<PassDeclaration>& passes);
std::vector<std::string> names_of(const std::vector<AovLayer>& layers);

/// Planes of one layer, with their conventional EXR channel names ("albedo.R", "depth.Z"). `frames`: frames since the
/// last change, the divisor of sums. Throws Error for an unknown name.
std::vector<ExrChannel> aov_planes(const BufferTable& buffers, const std::string& name, uint32_t frames,
                                   uint32_t correlated_frames);

}  // namespace relume
