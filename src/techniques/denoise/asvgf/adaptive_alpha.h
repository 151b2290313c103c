// Temporal filter of A-SVGF ([Schied18]): lays out the gradients for SVGF's filter, and turns the filtered ones into
// the weight by which histories are shortened.
#pragma once

#include "core/ray.h"
#include "techniques/denoise/asvgf/gradients.h"
#include "techniques/denoise/svgf/atrous.h"

namespace relume {

/// Planes of the gradients in the filter: δ and Δ. The others are not used.
inline constexpr uint32_t kGradientPlane = 0;
inline constexpr uint32_t kLargestPlane = 1;

/// Tolerance of light of a filter that only features stop. Times the variance that PrepareGradientsKernel writes, it
/// exceeds every contrast.
inline constexpr float kAnyLight = 1e30f;

/// Lays out gradients and the features of their strata. Grid: strata.
struct PrepareGradientsKernel {
  View<const Vec2> gradients;
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const float> depth;
  View<const uint32_t> surface;
  AtrousImage features;   ///< kAtrousPlanes planes
  AtrousImage planes;     ///< kAtrousChannels planes
  float cone_width = 0;   ///< width of a pixel at the camera, metres
  float cone_spread = 0;  ///< growth of that width per metre
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = pixel_of(x, y);
    const bool valid = surface[pixel] != kNoSurface;
    const float footprint = (cone_width + cone_spread * depth[pixel]) * static_cast<float>(kStratum);
    *features.at(place_of(AtrousPlane::valid), x, y) = valid ? 1.0f : 0.0f;
    *features.at(place_of(AtrousPlane::inverse_footprint), x, y) = footprint > 0.0f ? 1.0f / footprint : 0.0f;
    for (uint32_t c = 0; c < 3; ++c) {
      *features.at(place_of(AtrousPlane::normal_x, c), x, y) = normal[pixel][static_cast<int>(c)];
      *features.at(place_of(AtrousPlane::position_x, c), x, y) = position[pixel][static_cast<int>(c)];
    }
    // A stratum without a gradient adds nothing to either sum, so their quotient is that of the others. In the
    // background, where no neighbour is similar, the noise of a gradient would remain.
    const Vec2 gradient = valid ? gradients[y * features.width + x] : Vec2(0);
    *planes.at(kGradientPlane, x, y) = gradient.x;
    *planes.at(kLargestPlane, x, y) = gradient.y;
    *planes.at(2, x, y) = 0.0f;
    *planes.at(kAtrousVariance, x, y) = 1.0f;
  }

 private:
  /// The middle pixel of a stratum or, at a silhouette, its first one with a surface.
  RELUME_HD uint32_t pixel_of(uint32_t x, uint32_t y) const {
    const uint32_t end_x = relume::min((x + 1) * kStratum, width);
    const uint32_t end_y = relume::min((y + 1) * kStratum, height);
    const uint32_t middle_x = relume::min(x * kStratum + kStratum / 2, width - 1);
    uint32_t pixel = relume::min(y * kStratum + kStratum / 2, height - 1) * width + middle_x;
    for (uint32_t py = y * kStratum; py < end_y && surface[pixel] == kNoSurface; ++py) {
      for (uint32_t px = x * kStratum; px < end_x && surface[pixel] == kNoSurface; ++px) {
        if (surface[py * width + px] != kNoSurface) pixel = py * width + px;
      }
    }
    return pixel;
  }
};

/// λ of each pixel: the largest min(1, antilag · |δ| / Δ) of the 5 × 5 strata around it. Grid: strata.
struct LambdaKernel {
  AtrousImage filtered;  ///< gradients, filtered
  View<float> lambdas;   ///< per pixel, in [0, 1]; 0: nothing has changed
  float antilag = 1;
  uint32_t width = 0;  ///< pixels
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    constexpr uint32_t kReach = 2;
    float most = 0;
    for (uint32_t v = y > kReach ? y - kReach : 0; v <= y + kReach && v < filtered.height; ++v) {
      for (uint32_t u = x > kReach ? x - kReach : 0; u <= x + kReach && u < filtered.width; ++u)
        most = relume::max(most, lambda_at(u, v));
    }
    for (uint32_t py = y * kStratum; py < (y + 1) * kStratum && py < height; ++py) {
      for (uint32_t px = x * kStratum; px < (x + 1) * kStratum && px < width; ++px) lambdas[py * width + px] = most;
    }
  }

 private:
  RELUME_HD float lambda_at(uint32_t x, uint32_t y) const {
    const float change = std::fabs(*filtered.at(kGradientPlane, x, y));
    const float largest = *filtered.at(kLargestPlane, x, y);
    if (!(largest > 0.0f)) return 0.0f;  // no gradient, or black in both frames
    const float lambda = antilag * change / largest;
    return lambda > 0.0f ? relume::min(lambda, 1.0f) : 0.0f;  // 0 for NaN
  }
};

}  // namespace relume
