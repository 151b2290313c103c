// Small scene with most kinds of surfaces, one kind of light and one kind of camera.
#pragma once

#include "scene/scene.h"

namespace relume::testing {

enum class ZooLight {
  triangles,
  two_sided,
  textured,
  point,
  spot,
  directional,
  sun_disk,
  environment_map,
  sun_sky,
  constant,
  mixed,
};
inline constexpr ZooLight kZooLights[] = {
    ZooLight::triangles, ZooLight::two_sided,   ZooLight::textured, ZooLight::point,
    ZooLight::spot,      ZooLight::directional, ZooLight::sun_disk, ZooLight::environment_map,
    ZooLight::sun_sky,   ZooLight::constant,    ZooLight::mixed};
inline constexpr const char* kZooLightNames[] = {"triangles", "two_sided",   "textured", "point",
                                                 "spot",      "directional", "sun_disk", "environment_map",
                                                 "sun_sky",   "constant",    "mixed"};

enum class ZooCamera { pinhole, thin_lens, orthographic, panoramic };
inline constexpr ZooCamera kZooCameras[] = {ZooCamera::pinhole, ZooCamera::thin_lens, ZooCamera::orthographic,
                                            ZooCamera::panoramic};
inline constexpr const char* kZooCameraNames[] = {"pinhole", "thin_lens", "orthographic", "panoramic"};

/// `smooth`: adds delta scattering. `bent`: adds shading normals that differ from the geometric ones, where light
/// tracing loses some light.
Scene make_zoo(ZooLight light, ZooCamera camera, bool smooth = true, bool bent = true);

/// Inside of an emitting, reflecting sphere, seen by a panoramic camera. All its points see one another.
Scene make_closed_sphere(float albedo);

/// A lamp, a floor and a wall in a block of dark glass, seen from outside or from inside.
Scene make_lamp_in_glass(bool from_within = false);

/// The same from inside, with a lamp halfway out of the block.
Scene make_lamp_half_in_glass();

/// Sets the dispersion of all materials with a thickness.
Scene dispersive(Scene scene, float dispersion);
/// Wavelength of all paths in tests that fix it, nanometres.
inline constexpr float kZooWavelength = 450;

}  // namespace relume::testing
