// Tinted media around lights, where light subpaths start.
#pragma once

#include "scene/medium.h"

namespace relume {

/// Ray along which a light emits at a time within the shutter.
RELUME_HD inline Ray emitted_ray(const EmissionSample& e, float time) {
  Ray ray{e.origin, e.direction, kInfinity, time};
  if (!is_black(e.normal)) {
    // Conservative error bound for positions that the light computes itself.
    const float error = gamma_bound(64) * max_component(abs(e.origin)) + e.error;
    ray.origin = offset_origin(e.origin, error, e.normal, e.direction);
  }
  return ray;
}

/// Marks a light whose parts or sides are in different media.
inline constexpr float kSeveralMedia = -1;

/// Absorption along an emitted ray, per metre. `known`: that of the light, from LightMediumKernel.
RELUME_HD inline Rgb medium_at_light(const SceneView& scene, const Rgb& known, const Ray& emitted) {
  return known.r == kSeveralMedia ? absorption_around(scene, emitted) : known;
}

/// Finds the absorption at each light, per metre: the sum over all media around it. Rays from several points on the
/// light test it, at several times if the shutter is open; kSeveralMedia if they differ. Runs on a grid of lights × 1.
/// Lights at infinity are in no medium.
struct LightMediumKernel {
  SceneView scene;
  View<Rgb> medium;

  RELUME_HD void operator()(uint32_t light, uint32_t /*y*/) const {
    medium[light] = Rgb(0);
    bool found = false;
    for (uint32_t i = 0; i < kTries; ++i) {
      const auto random = [&](uint32_t k) { return to_unit_float(hash(light, i, k)); };
      const float time = scene.camera.shutter_open ? random(4) : kShutterMiddle;
      const EmissionSample e = sample_le(scene.lights, light, {random(2), random(3)}, {random(0), random(1)}, time);
      if (e.infinite) return;
      if (!e.valid()) continue;  // no emission there
      const Rgb around = absorption_around(scene, emitted_ray(e, time));
      if (found && !same_medium(around, medium[light])) {
        medium[light] = Rgb(kSeveralMedia);
        return;
      }
      medium[light] = around;
      if (is_black(e.normal)) return;  // a point light
      found = true;
    }
  }

 private:
  static constexpr uint32_t kTries = 16;

  /// Compares up to the rounding of sums in different orders.
  RELUME_HD static bool same_medium(const Rgb& a, const Rgb& b) {
    return max_component(abs(a - b)) <= 1e-4f * max_component(glm::max(a, b));
  }
};

}  // namespace relume
