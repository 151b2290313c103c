// Arbitrary output variables: planes that derive from the buffers.
#pragma once

#include <string>
#include <vector>

#include "film/buffer_table.h"
#include "io/image.h"
#include "pipeline/pipeline.h"

namespace relume {

/// "variance" and every buffer of the pipeline that is shown.
std::vector<std::string> aov_names(const Pipeline& pipeline);

/// Planes of one of them, with the conventional names of their EXR channels ("albedo.R", "depth.Z"). `frames`: since
/// the last change, by which sums are divided. Throws Error for a name that is not there.
std::vector<ExrChannel> aov_planes(const BufferTable& buffers, const std::string& name, uint32_t frames);

}  // namespace relume
