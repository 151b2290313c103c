// Which tinted bodies lights stand in: that is where light subpaths begin.
#pragma once

#include "scene/scene_view.h"
#include "scene/surface_point.h"

namespace relume {

/// What absorbs light at each light, per metre: that of all bodies around it. Found on a ray to where there is nothing
/// more: bodies that it leaves without having entered them. A grid of lights × 1; lights at infinity are in none.
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
      medium[light] = left_unentered(ray);
      return;
    }
  }

 private:
  static constexpr uint32_t kTries = 8;      ///< directions, until the light shines there
  static constexpr uint32_t kMaxSteps = 64;  ///< surfaces on the way
  static constexpr uint32_t kMaxBodies = 8;  ///< in one another

  RELUME_HD Rgb left_unentered(Ray ray) const {
    uint32_t entered[kMaxBodies];
    uint32_t count = 0;
    Rgb sum(0);
    for (uint32_t step = 0; step < kMaxSteps; ++step) {
      const Hit hit = intersect(scene.accel, ray, step);
      if (!hit.valid()) break;
      SurfacePoint sp;
      make_surface_point(scene, ray, hit, 0.0f, sp);
      if (scene.materials[sp.material].volume) {
        if (sp.front_face) {
          if (count < kMaxBodies) entered[count++] = sp.material;
        } else if (!forget(entered, count, sp.material)) {
          sum += scene.materials[sp.material].absorption;
        }
      }
      ray = sp.spawn_ray(ray.direction);
    }
    return sum;
  }

  /// Takes a body out of the list; false if it is not there.
  RELUME_HD static bool forget(uint32_t (&entered)[kMaxBodies], uint32_t& count, uint32_t body) {
    for (uint32_t i = count; i-- > 0;) {
      if (entered[i] != body) continue;
      entered[i] = entered[--count];
      return true;
    }
    return false;
  }
};

}  // namespace relume
