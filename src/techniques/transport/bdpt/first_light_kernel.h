// Completes the records of the light at first vertices, after all light subpaths of the frame.
#pragma once

#include "techniques/transport/bdpt/bdpt_context.h"

namespace relume {

/// Fills the surface at `hit`, the primary hit of pixel (x, y), for its record. Returns false if only delta lobes
/// scatter there.
RELUME_HD inline bool surface_of_record(const BdptContext& c, uint32_t x, uint32_t y, const Hit& hit, Sampler& sampler,
                                        SurfacePoint& sp) {
  const SceneView& scene = c.scene();
  const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
  make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp,
                     subpath_wavelength(c, sampler));
  return !sp.bsdf.empty() && has_non_delta(sp.bsdf);
}

/// Samples a light as next event estimation does, and records it for tests of changes of light.
RELUME_HD inline void record_light(const BdptContext& c, const SurfacePoint& sp, Sampler& sampler,
                                   FirstVertex& vertex) {
  sampler.start_dimension(kCameraDimensions);
  const LightPick pick = pick_light(c.path, sp, sampler);
  const LightSample light = sample_picked(c.path, sp, pick);
  if (!light.valid() || is_black(eval_pdf(sp, light.wi).f)) return;
  vertex.to_light = light.wi;
  vertex.light = pick.id;
  vertex.light_u = pick.u;
  vertex.light_scale = 1.0f / pick.pmf;
  if (occluded(c.scene(), shadow_ray(sp, light), sampler.ray_id())) return;
  vertex.light_value = luminance(light.radiance) * shading_cosine(sp, light.wi) / light.pdf_w;
}

/// Transmittance from the surface at `hit` to the camera.
RELUME_HD inline Rgb transmittance_to_camera(const SceneView& scene, const SurfacePoint& sp, const Hit& hit) {
  Rgb medium = scene.camera_medium;
  return transmittance_to(scene, sp, hit.t, medium);
}

/// One direction for all light that a surface reflects.
struct ChosenLight {
  Vec3 direction{0};
  Rgb arriving{0};  ///< as FirstVertex::indirect: the BSDF scales it to the reflected light
};

/// The chosen direction, an element of FirstLight::chosen, with all light `reflected`, as the camera receives it.
/// Without one, the direction of mirror reflection, in which reflection depends most on the view.
RELUME_HD inline ChosenLight light_along(const SurfacePoint& sp, uint64_t chosen, const Rgb& transmittance,
                                         const Rgb& reflected) {
  const Vec3 mirrored = sp.frame.to_world({-sp.wo_local.x, -sp.wo_local.y, sp.wo_local.z});
  ChosenLight light;
  light.direction = chosen == 0 ? mirrored : unpack_direction(static_cast<uint32_t>(chosen));
  Rgb f = eval_pdf(sp, light.direction).f;
  if (is_black(f)) {  // a splat on another surface in the pixel
    light.direction = mirrored;
    f = eval_pdf(sp, mirrored).f;
  }
  for (int c = 0; c < 3; ++c) {
    const float divisor = transmittance[c] * f[c];
    light.arriving[c] = reflected[c] > 0.0f && divisor > 0.0f ? reflected[c] / divisor : 0.0f;
  }
  return light;
}

/// Converts the chosen direction and the reflected light of each pixel to a FirstVertex, and samples a light there for
/// tests of changes of light. Where reservoirs add direct light, they record theirs instead.
struct FirstLightKernel {
  BdptContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  View<const Rgb> radiance;         ///< of this sample, with splats

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * context.width + x;
    const Hit& hit = hits[pixel];
    if ((!allocation.empty() && allocation[pixel] == 0) || !hit.valid()) return;
    Sampler sampler = index.sampler(x, y);
    SurfacePoint sp;
    if (!surface_of_record(context, x, y, hit, sampler, sp)) return;
    FirstVertex& vertex = context.first_light.vertices[pixel];
    if (context.path.first_nee_bounce == 0) record_light(context, sp, sampler, vertex);
    // Reflection by Lambertian surfaces is the same in all directions.
    if (is_lambert(sp.bsdf)) return;
    const Rgb transmittance = transmittance_to_camera(context.scene(), sp, hit);
    const Rgb reflected = radiance[pixel] - transmittance * sp.emission;
    const ChosenLight light = light_along(sp, context.first_light.chosen[pixel], transmittance, reflected);
    vertex.scatter = light.direction;
    vertex.indirect = light.arriving;
  }
};

}  // namespace relume
