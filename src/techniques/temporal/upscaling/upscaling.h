// Temporal upscaling: one path per frame in each block of n × n pixels. The pixels of a block take turns, so that n²
// frames sample every pixel once.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Pixel of a block.
struct BlockPosition {
  uint32_t x = 0;
  uint32_t y = 0;
};

namespace upscaling_detail {

/// Pixel of a 2 × 2 block, in the order of a Bayer matrix: (0, 0), (1, 1), (1, 0), (0, 1).
RELUME_HD constexpr BlockPosition turn_of_four(uint32_t turn) { return {(turn ^ (turn >> 1)) & 1u, turn & 1u}; }

}  // namespace upscaling_detail

/// Pixel that a block of n × n samples in a turn; n is at most 4. Bayer order for 2 and 4, along diagonals for 3.
RELUME_HD inline BlockPosition block_position(uint32_t n, uint32_t turn) {
  using upscaling_detail::turn_of_four;
  if (n == 2) return turn_of_four(turn);
  if (n == 4) {
    const BlockPosition quarter = turn_of_four(turn);
    const BlockPosition pixel = turn_of_four(turn / 4);
    return {2 * quarter.x + pixel.x, 2 * quarter.y + pixel.y};
  }
  const uint32_t stride = n + 1;  // a diagonal; coprime to n²
  const uint32_t index = turn % (n * n) * stride % (n * n);
  return {index % n, index / n};
}

/// Gives a sample to one pixel of each block.
struct BlockAllocationKernel {
  View<uint32_t> allocation;  ///< 0 or 1
  BlockPosition sampled;
  uint32_t block = 1;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    allocation[y * width + x] = x % block == sampled.x && y % block == sampled.y ? 1u : 0u;
  }
};

/// Fills pixels that have no sample yet with a mean of the samples around them, weighted by 1 / distance².
struct FillUnsampledKernel {
  View<const Rgb> mean;
  View<const uint32_t> samples;
  View<Rgb> filled;
  uint32_t block = 1;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    filled[pixel] = samples[pixel] > 0 ? mean[pixel] : from_surroundings(x, y);
  }

 private:
  RELUME_HD Rgb from_surroundings(uint32_t x, uint32_t y) const {
    const int reach = static_cast<int>(block) - 1;
    Rgb sum(0);
    float total = 0;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int px = static_cast<int>(x) + dx;
        const int py = static_cast<int>(y) + dy;
        if (px < 0 || py < 0 || px >= static_cast<int>(width) || py >= static_cast<int>(height)) continue;
        const uint32_t other = static_cast<uint32_t>(py) * width + static_cast<uint32_t>(px);
        if (samples[other] == 0) continue;
        const float weight = 1.0f / static_cast<float>(dx * dx + dy * dy);
        sum += mean[other] * weight;
        total += weight;
      }
    }
    return total > 0.0f ? sum / total : Rgb(0);
  }
};

}  // namespace relume
