// Absorption in the bodies that rays go through, by Beer's law. Whoever follows a way through the scene carries the
// medium that it is in: absorption per metre, that of all bodies around it.
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// What absorbs light beyond the surface in direction `w`, if `medium` does on the viewer's side. A body begins where
/// its front is passed and ends where its back is; bodies that overlap add up.
RELUME_HD inline Rgb medium_along(const SceneView& scene, const SurfacePoint& sp, const Vec3& w, const Rgb& medium) {
  if (!scene.absorbs || glm::dot(w, sp.ng) >= 0.0f) return medium;
  const MaterialData& material = scene.materials[sp.material];
  if (!material.volume) return medium;
  return sp.front_face ? medium + material.absorption : glm::max(medium - material.absorption, Rgb(0));
}

/// Share of light that `distance` metres let through. All of what comes from infinity: whoever sees that far has left a
/// body unnoticed, through an opening.
RELUME_HD inline Rgb transmittance(const Rgb& medium, float distance) {
  return is_black(medium) || distance == kInfinity ? Rgb(1) : exp(-medium * distance);
}

/// The same of the `distance` metres that end at a surface. `medium`: along them, as far as is known so far.
RELUME_HD inline Rgb transmittance_to(const SceneView& scene, const SurfacePoint& sp, float distance, Rgb& medium) {
  if (!scene.absorbs) return Rgb(1);
  const MaterialData& material = scene.materials[sp.material];
  // Who meets an inner side is inside, even if it did not see itself enter: through an opening, or one body in another.
  if (material.volume && !sp.front_face) medium = glm::max(medium, material.absorption);
  return transmittance(medium, distance);
}

namespace medium_detail {

inline constexpr uint32_t kMaxSteps = 64;  ///< surfaces on the way
inline constexpr uint32_t kMaxBodies = 8;  ///< in one another

/// Takes a body out of the list; false if it is not there.
RELUME_HD inline bool forget(uint32_t (&entered)[kMaxBodies], uint32_t& count, uint32_t body) {
  for (uint32_t i = count; i-- > 0;) {
    if (entered[i] != body) continue;
    entered[i] = entered[--count];
    return true;
  }
  return false;
}

}  // namespace medium_detail

/// What absorbs light where `ray` begins, per metre: that of all bodies around. The ray, followed to where there is
/// nothing more, leaves them without having entered them.
RELUME_HD inline Rgb absorption_around(const SceneView& scene, Ray ray) {
  using namespace medium_detail;
  uint32_t entered[kMaxBodies];
  uint32_t count = 0;
  Rgb sum(0);
  for (uint32_t step = 0; step < kMaxSteps && scene.absorbs; ++step) {
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

}  // namespace relume
