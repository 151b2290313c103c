// Limits samples that are much brighter than their neighbours. Loses energy of rare bright paths and reduces noise.
#pragma once

#include "core/vec.h"
#include "core/view.h"
#include "scene/scene_view.h"

namespace relume {

/// Radius of a sample's neighbourhood, pixels.
inline constexpr uint32_t kFireflyRadius = 2;

/// Factor in (0, 1] that limits the luminance of each pixel's sample to `limit` times the mean of its neighbours. It
/// stays 1 among black samples, which give no scale, and at pixels of emitters and the background.
struct FireflyFactorKernel {
  SceneView scene;
  View<const Hit> hits;
  View<const Rgb> radiance;         ///< radiance of this frame's samples
  View<const uint32_t> allocation;  ///< samples of a pixel in this frame, 0 or 1; empty: 1 everywhere
  View<float> factors;
  float limit = 0;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    factors[pixel] = 1.0f;
    if (!has_sample(pixel) || shows_emitter(hits[pixel])) return;
    const float value = luminance(radiance[pixel]);
    const float most = limit * mean_around(x, y);
    if (most > 0.0f && value > most) factors[pixel] = most / value;
  }

 private:
  RELUME_HD bool has_sample(uint32_t pixel) const {
    return (allocation.empty() || allocation[pixel] > 0) && is_finite(radiance[pixel]);
  }

  RELUME_HD bool shows_emitter(const Hit& hit) const {
    if (!hit.valid()) return true;
    const MeshView& mesh = scene.meshes[scene.instances[hit.instance].mesh];
    return max_component(scene.materials[mesh.material].emission) > 0.0f;
  }

  /// Mean luminance of the samples around (x, y), without its own; infinity without any.
  RELUME_HD float mean_around(uint32_t x, uint32_t y) const {
    float sum = 0;
    float count = 0;
    const uint32_t y1 = relume::min(y + kFireflyRadius, height - 1);
    const uint32_t x1 = relume::min(x + kFireflyRadius, width - 1);
    for (uint32_t v = y - relume::min(y, kFireflyRadius); v <= y1; ++v) {
      for (uint32_t u = x - relume::min(x, kFireflyRadius); u <= x1; ++u) {
        const uint32_t other = v * width + u;
        if ((u == x && v == y) || !has_sample(other)) continue;
        sum += luminance(radiance[other]);
        count += 1.0f;
      }
    }
    return count > 0.0f ? sum / count : kInfinity;
  }
};

/// Scales a buffer by the factors.
struct FireflyScaleKernel {
  View<const float> factors;
  View<Rgb> values;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (factors[pixel] < 1.0f) values[pixel] *= factors[pixel];
  }
};

}  // namespace relume
