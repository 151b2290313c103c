// Merging images whose samples were rendered in parts, on one machine or on many.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "relume/export.h"

namespace relume {

/// What merge_images() has merged.
struct MergeReport {
  uint32_t samples = 0;   ///< per pixel
  uint32_t missing = 0;   ///< samples before the last one that no part has
  std::string ranges;     ///< of the samples: "0-63,128-191"
  uint32_t replicas = 0;  ///< number of independent renders, if the technique adapts to samples; otherwise 0
};

/// Merges parts of an image (`relume render --sample-range`) with disjoint samples, in any order, and writes the image
/// of all their samples with the layers of the parts. Unless the technique adapts to its samples, the image and its
/// layers equal those of one render of these samples, bit for bit. Layers of one frame are those of the first sample
/// (motion) or the last (others). `output`: an .exr file. `keep_sums`: writes a part, which can be merged again. Holds
/// only some rows of each image in memory. Throws Error for files that do not belong together, and damaged ones; the
/// output is then unchanged.
RELUME_API MergeReport merge_images(const std::vector<std::filesystem::path>& parts,
                                    const std::filesystem::path& output, bool keep_sums = false);

}  // namespace relume
