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
  // Who meets an inner side is inside, even if it did not see itself enter: the camera may stand there.
  if (material.volume && !sp.front_face) medium = glm::max(medium, material.absorption);
  return transmittance(medium, distance);
}

}  // namespace relume
