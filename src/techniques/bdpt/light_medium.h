// Which tinted bodies lights stand in: that is where light subpaths begin.
#pragma once

#include "scene/medium.h"

namespace relume {

/// What absorbs light at each light, per metre: that of all bodies around it. A grid of lights × 1; lights
/// at infinity are in none.
struct LightMediumKernel {
  SceneView scene;
  View<Rgb> medium;

  RELUME_HD void operator()(uint32_t light, uint32_t /*y*/) const {
    medium[light] = Rgb(0);
    for (uint32_t i = 0; i < kTries; ++i) {
      const Vec2 u(to_unit_float(hash(light, i, 0u)), to_unit_float(hash(light, i, 1u)));
      const EmissionSample e = sample_le(scene.lights, light, Vec2(0.5f), u);
      if (e.infinite) return;
      if (!e.valid()) continue;
      Ray ray{e.origin, e.direction, kInfinity};
      if (!is_black(e.normal))
        ray.origin = offset_origin(e.origin, gamma_bound(64) * max_component(abs(e.origin)), e.normal, e.direction);
      medium[light] = absorption_around(scene, ray);
      return;
    }
  }

 private:
  static constexpr uint32_t kTries = 8;  ///< directions, until the light shines there
};

}  // namespace relume
