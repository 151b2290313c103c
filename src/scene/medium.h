// Absorption in the media along a ray, by Beer's law. A path tracks the absorption per metre, summed over all media
// around it.
#pragma once

#include "scene/ray_queries.h"
#include "scene/surface_point.h"

namespace relume {

/// Absorption beyond the surface in direction `w`, with `medium` on the viewer's side. A path enters a medium through a
/// front face and leaves it through a back face. Overlapping media add up.
RELUME_HD inline Rgb medium_along(const SceneView& scene, const SurfacePoint& sp, const Vec3& w, const Rgb& medium) {
  if (!scene.absorbs || glm::dot(w, sp.ng) >= 0.0f) return medium;
  const MaterialData& material = scene.materials[sp.material];
  if (!material.volume) return medium;
  return sp.front_face ? medium + material.absorption : glm::max(medium - material.absorption, Rgb(0));
}

/// Transmittance over `distance` metres. Returns 1 at infinity: the ray left through a hole in the mesh.
RELUME_HD inline Rgb transmittance(const Rgb& medium, float distance) {
  return is_black(medium) || distance == kInfinity ? Rgb(1) : exp(-medium * distance);
}

/// Transmittance over the `distance` metres that end at a surface. Updates `medium`, the absorption along them.
RELUME_HD inline Rgb transmittance_to(const SceneView& scene, const SurfacePoint& sp, float distance, Rgb& medium) {
  if (!scene.absorbs) return Rgb(1);
  const MaterialData& material = scene.materials[sp.material];
  // A back face implies that the ray was inside. It may have missed the entry, through a hole or where one medium
  // contains another.
  if (material.volume && !sp.front_face) medium = glm::max(medium, material.absorption);
  return transmittance(medium, distance);
}

namespace medium_detail {

inline constexpr uint32_t kMaxSteps = 64;  ///< surfaces along the ray
inline constexpr uint32_t kMaxMedia = 8;   ///< nested media

/// Removes a medium from the list. Returns false if the list does not contain it.
RELUME_HD inline bool remove_medium(uint32_t (&entered)[kMaxMedia], uint32_t& count, uint32_t medium) {
  for (uint32_t i = count; i-- > 0;) {
    if (entered[i] != medium) continue;
    entered[i] = entered[--count];
    return true;
  }
  return false;
}

}  // namespace medium_detail

/// Absorption at the origin of `ray`, per metre: the sum over all media around it. Follows the ray until it leaves the
/// scene: the ray leaves these media without having entered them.
RELUME_HD inline Rgb absorption_around(const SceneView& scene, Ray ray) {
  using namespace medium_detail;
  uint32_t entered[kMaxMedia];
  uint32_t count = 0;
  Rgb sum(0);
  for (uint32_t step = 0; step < kMaxSteps && scene.absorbs; ++step) {
    const Hit hit = intersect(scene, ray, step);
    if (!hit.valid()) break;
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, 0.0f, sp);
    // Mixtures are left out: their coin may differ between entry and exit.
    const uint32_t outer = scene.meshes[scene.instances[hit.instance].mesh].material;
    if (outer == sp.material && scene.materials[sp.material].volume) {
      if (sp.front_face) {
        if (count < kMaxMedia) entered[count++] = sp.material;
      } else if (!remove_medium(entered, count, sp.material)) {
        sum += scene.materials[sp.material].absorption;
      }
    }
    ray = sp.spawn_ray(ray.direction);
  }
  return sum;
}

}  // namespace relume
