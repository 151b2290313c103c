// Which tinted bodies lights stand in: that is where light subpaths begin.
#pragma once

#include "scene/medium.h"

namespace relume {

/// The ray along which a light emits.
RELUME_HD inline Ray emitted_ray(const EmissionSample& e) {
  Ray ray{e.origin, e.direction, kInfinity};
  if (!is_black(e.normal)) {
    // A generous bound for what the light computes of its own.
    const float error = gamma_bound(64) * max_component(abs(e.origin)) + e.error;
    ray.origin = offset_origin(e.origin, error, e.normal, e.direction);
  }
  return ray;
}

/// Stands for the medium of a light whose parts, or sides, are in different ones.
inline constexpr float kSeveralMedia = -1;

/// What absorbs along a ray that a light emits; `known`: of the light, by LightMediumKernel.
RELUME_HD inline Rgb medium_at_light(const SceneView& scene, const Rgb& known, const Ray& emitted) {
  return known.r == kSeveralMedia ? absorption_around(scene, emitted) : known;
}

/// What absorbs light at each light, per metre: that of all bodies around it, as rays from several places on it tell;
/// kSeveralMedia if they do not agree. A grid of lights × 1; lights at infinity are in none.
struct LightMediumKernel {
  SceneView scene;
  View<Rgb> medium;

  RELUME_HD void operator()(uint32_t light, uint32_t /*y*/) const {
    medium[light] = Rgb(0);
    bool found = false;
    for (uint32_t i = 0; i < kTries; ++i) {
      const auto random = [&](uint32_t k) { return to_unit_float(hash(light, i, k)); };
      const EmissionSample e = sample_le(scene.lights, light, {random(2), random(3)}, {random(0), random(1)});
      if (e.infinite) return;
      if (!e.valid()) continue;  // dark there
      const Rgb around = absorption_around(scene, emitted_ray(e));
      if (found && !alike(around, medium[light])) {
        medium[light] = Rgb(kSeveralMedia);
        return;
      }
      medium[light] = around;
      if (is_black(e.normal)) return;  // a point
      found = true;
    }
  }

 private:
  static constexpr uint32_t kTries = 16;

  /// But for the order in which bodies were summed up.
  RELUME_HD static bool alike(const Rgb& a, const Rgb& b) {
    return max_component(abs(a - b)) <= 1e-4f * max_component(glm::max(a, b));
  }
};

}  // namespace relume
