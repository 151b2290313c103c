// Auxiliary images for Open Image Denoise.
#pragma once

#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Means of albedo and normal over the frames since the last change, as smooth at edges as the image.
struct OidnAuxiliaryKernel {
  View<const Rgb> feature_albedo;
  View<const Rgb> feature_emission;
  View<const Vec3> feature_normal;
  View<Rgb> albedo;
  View<Vec3> normal;
  float share = 1;  ///< weight of this frame
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    // The library expects emitters to be white.
    const Rgb now = glm::min(feature_albedo[pixel] + feature_emission[pixel], Rgb(1));
    const Rgb before = share < 1.0f ? albedo[pixel] : Rgb(0);
    const Vec3 normal_before = share < 1.0f ? normal[pixel] : Vec3(0);
    albedo[pixel] = before + (now - before) * share;
    normal[pixel] = normal_before + (feature_normal[pixel] - normal_before) * share;
  }
};

/// Divides the image between the caustic layer and the rest, for the library to filter each of them. Neither is
/// negative where the image is not: the library clamps negative values.
struct OidnSplitKernel {
  View<const Rgb> image;
  View<const Rgb> caustics;
  View<Rgb> layer;
  View<Rgb> rest;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    layer[pixel] = glm::min(caustics[pixel], glm::max(image[pixel], Rgb(0)));
    rest[pixel] = image[pixel] - layer[pixel];
  }
};

/// Adds the filtered caustic layer to the filtered rest of the image.
struct OidnSumKernel {
  View<const Rgb> layer;
  View<Rgb> image;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    image[pixel] += layer[pixel];
  }
};

/// Whether the image is filtered after `frames` frames without a change. True up to 15, then every 2^k / 8 frames
/// between frames 2^k and 2^(k+1): filtering takes longer than a frame, and its result changes less and less.
constexpr bool oidn_filters_at(uint32_t frames) {
  uint32_t eighth = 1;
  while (eighth * 16 <= frames) eighth *= 2;
  return frames % eighth == 0;
}

}  // namespace relume
