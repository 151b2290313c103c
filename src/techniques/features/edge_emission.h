// The emission that pixels at the edges of something bright see, from more camera rays than the sample's. It takes the
// place of what the sample saw of it: the mean of the pixel stays as it is, and most of its noise goes.
#pragma once

#include "techniques/features/features.h"
#include "techniques/primary_hits/emission_edges.h"

namespace relume {

/// Finds such pixels and measures what they see.
struct MeasureEdgesKernel {
  SceneView scene;
  SampleIndex index;
  View<const Rgb> radiance;         ///< of this frame's samples
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1
  View<const Rgb> albedo;           ///< the samples' features
  View<const Rgb> emission;
  View<Rgb> edge_emission;   ///< mean of the rays
  View<uint32_t> edge_rays;  ///< their number; 0: no edge
  uint32_t rays = 0;         ///< for each such pixel
  uint32_t max_steps = kMaxFeatureSteps;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const bool edge = rays > 0 && is_edge(x, y);
    edge_rays[pixel] = edge ? rays : 0u;
    edge_emission[pixel] = edge ? measure(x, y) : Rgb(0);
  }

 private:
  /// Samples of single pixels are too noisy to say how dark it is beside a lamp; their mean stands for each of them.
  RELUME_HD bool is_edge(uint32_t x, uint32_t y) const {
    const auto seen = [&](uint32_t i) { return luminance(emission[i]); };
    const auto shown = [&](uint32_t i) { return seen(i) + (is_filtered(albedo[i]) ? scattered_around(x, y) : 0.0f); };
    return is_emission_edge(x, y, width, height, seen, shown);
  }

  /// Mean luminance of what the surfaces around scatter.
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
    return count > 0.0f ? sum / count : 0.0f;
  }

  /// One sequence runs through all frames, as nothing here adapts.
  RELUME_HD Rgb measure(uint32_t x, uint32_t y) const {
    constexpr uint32_t kSalt = 0x5bd1e995u;
    const FeatureTracer tracer{scene, max_steps};
    Rgb sum(0);
    for (uint32_t k = 0; k < rays; ++k) {
      const uint32_t sample = (index.independent ? index.frame : index.sample) * rays + k;
      Sampler sampler = Sampler::sequence(index.seed ^ kSalt, x, y, sample);
      const Ray ray = camera_ray(scene.camera, x, y, sampler);
      const uint32_t ray_id = sampler.camera_ray_id();
      sum += tracer.trace(ray, intersect(scene.accel, ray, ray_id), ray_id).emission;
    }
    return sum / static_cast<float>(rays);
  }
};

/// Puts it in the place of the sample's, in the radiance and among the features.
struct ReplaceEmissionKernel {
  View<const Rgb> edge_emission;
  View<const uint32_t> edge_rays;
  View<const uint32_t> allocation;
  View<Rgb> radiance;
  View<Rgb> emission;
  View<uint32_t> rays;  ///< of this frame's sample; those of edges are added
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (edge_rays[pixel] == 0) return;
    const bool sampled = allocation.empty() || allocation[pixel] != 0;
    if (sampled) radiance[pixel] = edge_emission[pixel] + (radiance[pixel] - emission[pixel]);
    emission[pixel] = edge_emission[pixel];
    rays[pixel] += edge_rays[pixel];
  }
};

}  // namespace relume
