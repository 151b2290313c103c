// Kernels of the caustic layer, beside the filter of SVGF. Its light is not divided by albedo: light paths reach all
// points of a pixel, and the albedo is that of one camera ray. Its noise comes from the light paths: the difference of
// two halves of them has the variance of their sum ([Rousselle12]), from the first frame on.
#pragma once

#include "techniques/denoise/shared/light_history.h"
#include "techniques/denoise/svgf/atrous.h"
#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Marks pixels whose light is filtered, by an albedo that leaves the layer as it is.
struct CausticAlbedoKernel {
  View<const Rgb> feature_albedo;
  View<Rgb> albedo;  ///< 1 where light is filtered, else 0
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    albedo[pixel] = Rgb(is_filtered(feature_albedo[pixel]) ? 1.0f : 0.0f);
  }
};

/// Temporal accumulation of the layer and of the variance of a frame's light.
struct CausticAccumulateKernel {
  LightHistory history;
  View<const Rgb> differences;  ///< kCausticDifference
  View<const float> noise_before;
  View<float> noise;  ///< mean estimate of the variance of a frame's luminance

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const PixelHistory pixel = history.accumulate(x, y);
    const uint32_t i = history.pixel(x, y);
    noise[i] = pixel.mean(noise_before, sqr(luminance(differences[i])));
  }
};

/// Computes the variance of the accumulated layer and lays out the planes of the filter.
struct CausticPrepareKernel {
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const Rgb> albedo;
  View<const float> depth;
  View<const Rgb> light;
  View<const float> noise;
  View<const uint32_t> count;
  AtrousImage features;
  AtrousImage planes;           ///< light and variance
  float cone_width = 0;         ///< width of a pixel at the camera, metres
  float cone_spread = 0;        ///< growth of that width per metre
  float correlated_frames = 1;  ///< as in FrameContext
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const float footprint = footprint_at(pixel);
    Rgb shown = light[pixel];
    float variance = 0.0f;
    bool valid = is_filtered(albedo[pixel]);
    if (valid) {
      const Surroundings around = surroundings(x, y);
      valid = around.count > 0.0f;
      if (count[pixel] == 0) shown = around.light;
      const auto n = static_cast<float>(static_cast<int>(relume::max(count[pixel], 1u)));
      variance = around.noise / n * relume::min(n, correlated_frames);
    }
    put(AtrousPlane::valid, x, y, valid ? 1.0f : 0.0f);
    put(AtrousPlane::inverse_footprint, x, y, footprint > 0.0f ? 1.0f / footprint : 0.0f);
    for (uint32_t c = 0; c < 3; ++c) {
      *features.at(place_of(AtrousPlane::normal_x, c), x, y) = normal[pixel][static_cast<int>(c)];
      *features.at(place_of(AtrousPlane::position_x, c), x, y) = position[pixel][static_cast<int>(c)];
      *planes.at(c, x, y) = shown[static_cast<int>(c)];
    }
    *planes.at(kAtrousVariance, x, y) = variance;
  }

 private:
  /// Frames from which on fewer neighbours suffice for an estimate of noise.
  static constexpr uint32_t kManyFrames = 4;

  /// Means over the pixels around one that have samples.
  struct Surroundings {
    Rgb light{0};     ///< mean light of the pixels on the plane of the center; of all if none is
    float noise = 0;  ///< mean noise of the pixels on the plane
    float count = 0;  ///< number of pixels on the plane
  };

  RELUME_HD float footprint_at(uint32_t pixel) const { return cone_width + cone_spread * depth[pixel]; }

  /// The estimate of one pixel has a single degree of freedom. Pixels without samples take the light of a larger
  /// neighbourhood.
  RELUME_HD int reach_of(uint32_t pixel) const {
    if (count[pixel] == 0) return 3;
    return count[pixel] < kManyFrames ? 2 : 1;
  }

  RELUME_HD Surroundings surroundings(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const int reach = reach_of(pixel);
    const float distance = footprint_at(pixel) * static_cast<float>(reach);
    Surroundings on_plane;
    Rgb anywhere(0);
    float count_anywhere = 0;
    for (int dy = -reach; dy <= reach; ++dy) {
      for (int dx = -reach; dx <= reach; ++dx) {
        const int qx = static_cast<int>(x) + dx;
        const int qy = static_cast<int>(y) + dy;
        if (qx < 0 || qy < 0 || qx >= static_cast<int>(width) || qy >= static_cast<int>(height)) continue;
        const uint32_t other = static_cast<uint32_t>(qy) * width + static_cast<uint32_t>(qx);
        if (count[other] == 0 || !is_filtered(albedo[other])) continue;
        anywhere += light[other];
        count_anywhere += 1.0f;
        if (!same_plane(pixel, other, distance)) continue;
        on_plane.light += light[other];
        on_plane.noise += noise[other];
        on_plane.count += 1.0f;
      }
    }
    const bool any = on_plane.count > 0.0f;
    const float divisor = relume::max(any ? on_plane.count : count_anywhere, 1.0f);
    return {(any ? on_plane.light : anywhere) / divisor, on_plane.noise / divisor, on_plane.count};
  }

  RELUME_HD bool same_plane(uint32_t pixel, uint32_t other, float distance) const {
    if (pixel == other) return true;
    const Vec3& n = normal[pixel];
    return std::fabs(glm::dot(n, position[other] - position[pixel])) <= distance && glm::dot(n, normal[other]) > 0.9f;
  }

  RELUME_HD void put(AtrousPlane plane, uint32_t x, uint32_t y, float value) const {
    *features.at(place_of(plane), x, y) = value;
  }
};

/// Stores the filtered layer. Unfiltered pixels get black: they show their whole radiance, which contains the layer.
struct CausticPresentKernel {
  View<const Rgb> albedo;
  AtrousImage filtered;
  View<Rgb> caustics;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const bool shown = is_filtered(albedo[pixel]);
    caustics[pixel] = shown ? Rgb(*filtered.at(0, x, y), *filtered.at(1, x, y), *filtered.at(2, x, y)) : Rgb(0);
  }
};

}  // namespace relume
