// Files of merged sums: the checkpoints of renders on several ranks, and parts that `relume merge` reads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "framebuffer/pixel_sums.h"
#include "parts/part_info.h"
#include "relume/image.h"

namespace relume {

/// The samples of sums, and the image that they belong to.
struct MergedSums {
  int width = 0;
  int height = 0;
  PixelWindow window;     ///< the rendered pixels; not empty
  Attributes attributes;  ///< of the image
  SampleRanges samples;
  bool surface = false;
  uint32_t correlated_frames = 1;
  uint32_t replicas = 0;  ///< as PartInfo::replicas
};

/// Whether a file that exists is an EXR, and so no checkpoint of one process.
bool is_sums_file(const std::filesystem::path& file);

/// Writes the image and the sums, atomically. `sums`: of all pixels. Throws Error.
void write_sums_file(const std::filesystem::path& file, const MergedSums& merged, std::span<const PixelSums> sums);

/// Adds the sums of the file to `sums`. Throws Error unless they belong to the image of `expected`.
PartInfo read_sums_file(const std::filesystem::path& file, const MergedSums& expected, std::span<PixelSums> sums);

}  // namespace relume
