// Intel's Open Image Denoise behind two functions. The build decides whether the library is available.
#pragma once

#include <cstdint>
#include <string>

#include "core/vec.h"

namespace relume {

/// Empty if the library is available; otherwise a sentence on how to get it.
std::string oidn_missing();

/// Images of width × height pixels, row by row.
struct OidnImages {
  const Rgb* color = nullptr;   ///< noisy, linear
  const Rgb* albedo = nullptr;  ///< in [0, 1]; nullptr: not used, nor are normals
  const Vec3* normal = nullptr;
  Rgb* output = nullptr;
  uint32_t width = 0;
  uint32_t height = 0;
};

/// Filters with `threads` threads. Throws Error with the library's message on failure, or if the library is missing.
void oidn_filter(const OidnImages& images, int threads);

}  // namespace relume
