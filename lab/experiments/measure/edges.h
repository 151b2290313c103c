// Pixels along edges of depth and of shadows, and their blocks: where reuse across an edge could add bias.
#pragma once

#include <cstddef>
#include <vector>

#include "compare/reference.h"
#include "experiments/measure/pixel_mask.h"
#include "relume/image_io.h"

namespace relume {

/// Pixels beside a neighbour whose depth differs by 10 %, or whose normal by the cosine 0.9. Requires the reference's
/// surfaces.
PixelMask depth_edges(const Reference& reference);

/// Other pixels beside a neighbour whose light differs by at least 30 % and by three standard errors.
PixelMask shadow_edges(const Reference& reference);

/// The pixels of a mask in one block of the image.
struct EdgeBlock {
  int x = 0;  ///< corner, pixels
  int y = 0;
  std::vector<size_t> pixels;
};

/// Blocks of `size` × `size` pixels with at least `least` pixels of the mask.
std::vector<EdgeBlock> blocks_of(const PixelMask& mask, int width, int height, int size, size_t least);

/// Means over runs minus the reference, for one set of pixels.
struct BlockBias {
  double reference = 0;  ///< mean over the pixels and over R, G and B
  double bias = 0;
  double error = 0;  ///< standard error, of the runs and of the reference

  /// The bias in standard errors.
  double significance() const { return error > 0 ? bias / error : 0; }
};

/// `runs`: images with independent seeds, at least two. Frames and pixels of a run may depend on each other.
BlockBias block_bias(const std::vector<Image>& runs, const Reference& reference, const std::vector<size_t>& pixels);

/// Indices of a mask's pixels.
std::vector<size_t> pixels_in(const PixelMask& mask);

}  // namespace relume
