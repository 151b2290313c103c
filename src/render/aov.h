// Arbitrary output variables: planes that derive from the buffers.
#pragma once

#include <string>
#include <vector>

#include "frame/pass.h"
#include "framebuffer/buffer_table.h"
#include "relume/image_io.h"

namespace relume {

struct AovLayer {
  std::string name;
  std::string help;  ///< what it shows
};

/// "variance" and every buffer of these passes that is shown, by name.
std::vector<AovLayer> aov_layers(const std::vector<PassDeclaration>& passes);
std::vector<std::string> names_of(const std::vector<AovLayer>& layers);

/// Planes of one of them, with the conventional names of their EXR channels ("albedo.R", "depth.Z"). `frames`: since
/// the last change, by which sums are divided. Throws Error for a name that is not there.
std::vector<ExrChannel> aov_planes(const BufferTable& buffers, const std::string& name, uint32_t frames);

}  // namespace relume
