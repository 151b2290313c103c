// Wavelength dependence of scattering along a path. A path has one wavelength from the camera to the light. Its weight
// in the image channels is applied once, at the first vertex whose scattering depends on the wavelength.
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Wavelength dependence of scattering at a surface.
enum class Dispersion : uint8_t {
  none,
  transmission,  ///< from outside a dispersive medium
  always,        ///< from inside: the critical angle of total reflection also depends on the wavelength
};

RELUME_HD inline Dispersion dispersion_at(const SceneView& scene, const SurfacePoint& sp) {
  if (!scene.disperses || !(scene.materials[sp.material].dispersion > 0.0f)) return Dispersion::none;
  return sp.front_face ? Dispersion::transmission : Dispersion::always;
}

/// Whether scattering towards a direction depends on the wavelength. `cosine`: between the direction and the geometric
/// normal on the viewer's side.
RELUME_HD inline bool disperses(Dispersion dispersion, float cosine) {
  return dispersion == Dispersion::always || (dispersion == Dispersion::transmission && cosine < 0.0f);
}

/// The same for scattering at `sp` towards `w`.
RELUME_HD inline bool disperses(const SceneView& scene, const SurfacePoint& sp, const Vec3& w) {
  return scene.disperses && disperses(dispersion_at(scene, sp), glm::dot(sp.ng, w));
}

}  // namespace relume
