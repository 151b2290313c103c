// The primary hit of a pixel as a receiver of direct light, and the target function of its reservoirs.
#pragma once

#include "techniques/reuse/reservoir/light_point.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// Everything that the target of a pixel depends on besides the scene. A copy of it restores the pixel's receiver for
/// its neighbours, and in the next frame.
struct ReceiverRecord {
  Hit hit;            ///< no hit: the pixel has no receiver
  Vec3 origin{0};     ///< of the camera ray
  Vec3 direction{0};  ///< of the camera ray
  float wavelength_nm = kNoWavelength;
  uint32_t ray_id = 0;  ///< reservoir_ray_id()

  RELUME_HD bool valid() const { return hit.valid(); }
};

struct Receiver {
  SurfacePoint sp;
  PathState path;  ///< of a path that has arrived there: throughput, medium, wavelength
  uint32_t ray_id = 0;
};

/// Whether a hit refers to a visible surface: instances can be hidden, and a damaged checkpoint may hold any numbers.
RELUME_HD inline bool exists(const SceneView& scene, const Hit& hit) {
  if (hit.instance >= scene.instances.size || !is_finite(hit.u) || !is_finite(hit.v)) return false;
  const Instance& instance = scene.instances[hit.instance];
  return instance.visible && hit.primitive < scene.meshes[instance.mesh].triangle_count;
}

/// Record of pixel (x, y) with this primary hit, without testing whether the surface scatters.
RELUME_HD inline ReceiverRecord record_of(const SceneView& scene, uint32_t x, uint32_t y, const Sampler& sampler,
                                          const Hit& hit) {
  Sampler camera = sampler;
  const Ray ray = lone_camera_ray(scene.camera, x, y, camera);
  return {hit, ray.origin, ray.direction, path_wavelength(scene, sampler), reservoir_ray_id(sampler)};
}

/// Fills the receiver of a record. `camera`: that of its frame. `instance`: of the hit, as placed in that frame.
RELUME_HD inline void make_receiver(const SceneView& scene, const CameraView& camera, const Instance& instance,
                                    const ReceiverRecord& record, Receiver& r) {
  r.path = {};
  r.path.ray = {record.origin, record.direction, kInfinity};
  r.path.medium = scene.camera_medium;
  r.path.wavelength_nm = record.wavelength_nm;
  r.ray_id = record.ray_id;
  const Hit& hit = record.hit;
  make_surface_point(scene, instance, r.path.ray, hit, camera.cone_width() + camera.cone_spread() * hit.t, r.sp,
                     record.wavelength_nm);
  absorb(scene, r.sp, hit.t, r.path);
  if (scene.disperses) disperse(scene, r.sp, r.sp.ng, TransportMode::radiance, r.path);
}
RELUME_HD inline void make_receiver(const SceneView& scene, const ReceiverRecord& record, Receiver& r) {
  make_receiver(scene, scene.camera, scene.instances[record.hit.instance], record, r);
}

/// Light that the receiver reflects to the camera from a sample of a light, without occlusion and without the path's
/// throughput: the integrand over the density of the sample. Black for invalid samples.
RELUME_HD inline Rgb reflected(const SceneView& scene, const Receiver& r, const LightSample& light,
                               const BsdfEval& bsdf) {
  if (!light.valid() || is_black(bsdf.f)) return Rgb(0);
  Rgb value = bsdf.f * light.radiance * (shading_cosine(r.sp, light.wi) / light.pdf_w);
  if (scene.absorbs) value *= transmittance(medium_along(scene, r.sp, light.wi, r.path.medium), light.distance);
  if (scene.disperses) value *= dispersion_weight(scene, r.sp, light.wi, r.path);
  return value;
}
RELUME_HD inline Rgb reflected(const SceneView& scene, const Receiver& r, const LightSample& light) {
  return light.valid() ? reflected(scene, r, light, eval_pdf(r.sp, light.wi)) : Rgb(0);
}

/// Whether nothing blocks the receiver's view of a light sample. Always the same for the same receiver and sample,
/// also behind stochastic alpha.
RELUME_HD inline bool sees(const SceneView& scene, const Receiver& r, const LightSample& light) {
  return !occluded(scene, shadow_ray(r.sp, light), r.ray_id);
}

/// p̂ of a point at the receiver: the luminance of the integrand, 0 behind occluders if `traced`. `lights`: those of
/// the receiver's frame. Adds traced rays to `rays`.
RELUME_HD inline float target_at(const SceneView& scene, const LightsView& lights, const Receiver& r,
                                 const LightPoint& point, bool traced, uint32_t& rays) {
  const LightSample light = light_at(lights, point, r.sp.position);
  const float target = luminance(reflected(scene, r, light));
  if (!(target > 0.0f)) return 0.0f;
  if (!traced) return target;
  ++rays;
  return sees(scene, r, light) ? target : 0.0f;
}

}  // namespace relume
