// Emission at edges of lamps and sky, from more camera rays than the sample's. Their mean replaces the sample's
// emission, which leaves the mean of the pixel unchanged and removes most of its noise.
#pragma once

#include <algorithm>

#include "core/lane_views.h"
#include "frame/tile_rows.h"
#include "techniques/gbuffer/features/features.h"
#include "techniques/gbuffer/primary_hits/emission_edges.h"

namespace relume {

/// Finds pixels on edges of emission and measures their mean emission.
struct MeasureEdgesKernel {
  SceneView scene;
  SampleIndex index;
  View<const Rgb> radiance;         ///< radiance of this frame's samples
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1 everywhere
  View<const Rgb> albedo;           ///< albedo of the samples' features
  View<const Rgb> emission;
  View<Rgb> shown_emission;  ///< mean of the rays; elsewhere the sample's emission
  /// Camera rays of the pixel; 0: no edge. An edge remains one until something changes: otherwise parts of a
  /// low-discrepancy sequence would be left out by chance.
  View<uint32_t> edge_rays;
  uint32_t rays = 0;  ///< rays per pixel on an edge
  uint32_t max_steps = kMaxFeatureSteps;
  uint32_t width = 0;
  uint32_t height = 0;

  /// Host: kLanes pixels at once where no pixel around emits light.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      if (!is_dark(x, y)) return false;
      const uint32_t first = y * width + x;
      std::fill_n(&edge_rays[first], kLanes, 0u);
      std::copy_n(&emission[first], kLanes, &shown_emission[first]);
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const bool edge = rays > 0 && (edge_rays[pixel] > 0 || is_edge(x, y));
    edge_rays[pixel] = edge ? rays : 0u;
    shown_emission[pixel] = edge ? measure(x, y) : emission[pixel];
  }

 private:
  /// Host: whether kLanes pixels from (x, y) on were no edges, and emission in and around them is black.
  bool is_dark(uint32_t x, uint32_t y) const {
    if (x == 0 || x + kLanes >= width) return false;
    for (uint32_t k = 0; k < kLanes; ++k) {
      if (edge_rays[y * width + x + k] > 0) return false;
    }
    const Lanes zero(0.0f);
    LaneMask dark = zero <= zero;
    for (uint32_t row = y > 0 ? y - 1 : 0; row <= y + 1 && row < height; ++row) {
      const float* values = &emission[row * width + x - 1].x;
      for (const uint32_t i : {0u, kLanes, 2 * kLanes, 3 * (kLanes + 2) - kLanes}) {  // the last two overlap
        const Lanes some = load_lanes(values + i);
        dark = dark & (some <= zero) & (zero <= some);
      }
    }
    return !any_of(!dark);
  }

  RELUME_HD bool is_edge(uint32_t x, uint32_t y) const {
    const auto seen = [&](uint32_t i) { return luminance(emission[i]); };
    const float contrast = emission_contrast(x, y, width, height, seen);
    if (!(contrast > 0.0f)) return false;
    const float scattered = scattered_around(x, y);
    const auto shown = [&](uint32_t i) { return seen(i) + (is_filtered(albedo[i]) ? scattered : 0.0f); };
    return contrast > kEmissionContrast * darkest_around(x, y, width, height, shown);
  }

  /// Mean luminance of the light that neighbours scatter: single samples beside a lamp are too noisy. Infinity without
  /// any sample, which makes no edge.
  RELUME_HD float scattered_around(uint32_t x, uint32_t y) const {
    float sum = 0;
    float count = 0;
    uint32_t i = 0;
    for (uint32_t k = 0; k < kNeighbours; ++k) {
      if (!neighbour_of(k, x, y, width, height, i) || !is_filtered(albedo[i])) continue;
      if ((!allocation.empty() && allocation[i] == 0) || !is_finite(radiance[i])) continue;
      sum += relume::max(luminance(radiance[i] - emission[i]), 0.0f);
      count += 1.0f;
    }
    return count > 0.0f ? sum / count : kInfinity;
  }

  RELUME_HD Rgb measure(uint32_t x, uint32_t y) const {
    const FeatureTracer tracer{scene, max_steps};
    return mean_emission(index, rays, x, y, [&](Sampler& sampler) {
      const Ray ray = camera_ray(scene.camera, x, y, sampler);
      const uint32_t ray_id = sampler.camera_ray_id();
      return tracer.trace(ray, intersect_from_camera(scene, ray, ray_id), ray_id).emission;
    });
  }
};

/// Replaces the sample's emission in its radiance by the shown emission.
struct ReplaceEmissionKernel {
  View<const Rgb> emission;
  View<const Rgb> shown_emission;
  View<const uint32_t> edge_rays;
  View<const uint32_t> allocation;
  View<Rgb> radiance;
  View<Rgb> scattered;  ///< radiance without the sample's emission; added to that of a sun, it would be lost
  View<uint32_t> rays;  ///< rays of this frame's sample, plus the camera rays of edges
  uint32_t width = 0;
  View<const Rgb> caustics = {};  ///< caustic layer, which `radiance` contains and `scattered` does not; may be empty

  /// Host: kLanes pixels at once where none is an edge.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      const uint32_t first = y * width + x;
      for (uint32_t k = 0; k < kLanes; ++k) {
        if (edge_rays[first + k] != 0) return false;
      }
      const Triple<Lanes> all =
          vector_at<Lanes>({radiance.data, radiance.size}, first) - vector_at<Lanes>(emission, first);
      set_vector(scattered, first, caustics.empty() ? all : all - vector_at<Lanes>(caustics, first));
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb all = radiance[pixel] - emission[pixel];
    scattered[pixel] = caustics.empty() ? all : all - caustics[pixel];
    if (edge_rays[pixel] == 0) return;
    if (allocation.empty() || allocation[pixel] != 0) radiance[pixel] = shown_emission[pixel] + all;
    rays[pixel] += edge_rays[pixel];
  }
};

}  // namespace relume
