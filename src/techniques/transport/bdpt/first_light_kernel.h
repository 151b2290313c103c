// Completes the records of the light at first vertices, after all light subpaths of the frame.
#pragma once

#include "techniques/transport/bdpt/bdpt_context.h"

namespace relume {

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
    const SceneView& scene = context.scene();
    Sampler sampler = index.sampler(x, y);
    const Ray ray = lone_camera_ray(scene.camera, x, y, sampler);
    SurfacePoint sp;
    make_surface_point(scene, ray, hit, scene.camera.cone_width() + scene.camera.cone_spread() * hit.t, sp,
                       subpath_wavelength(context, sampler));
    if (sp.bsdf.empty() || !has_non_delta(sp.bsdf)) return;
    FirstVertex& vertex = context.first_light.vertices[pixel];
    if (context.path.first_nee_bounce == 0) sample_light(sp, sampler, vertex);
    // Reflection by Lambertian surfaces is the same in all directions.
    if (!is_lambert(sp.bsdf)) record_direction(sp, hit, pixel, vertex);
  }

 private:
  /// Samples a light as next event estimation does.
  RELUME_HD void sample_light(const SurfacePoint& sp, Sampler& sampler, FirstVertex& vertex) const {
    sampler.start_dimension(kCameraDimensions);
    const LightPick pick = pick_light(context.path, sp, sampler);
    const LightSample light = sample_picked(context.path, sp, pick);
    if (!light.valid() || is_black(eval_pdf(sp, light.wi).f)) return;
    vertex.to_light = light.wi;
    vertex.light = pick.id;
    vertex.light_u = pick.u;
    vertex.light_scale = 1.0f / pick.pmf;
    if (occluded(context.scene(), shadow_ray(sp, light), sampler.ray_id())) return;
    vertex.light_value = luminance(light.radiance) * shading_cosine(sp, light.wi) / light.pdf_w;
  }

  /// Records the chosen direction with all reflected light. Without one, the direction of mirror reflection, in which
  /// reflection depends most on the view.
  RELUME_HD void record_direction(const SurfacePoint& sp, const Hit& hit, uint32_t pixel, FirstVertex& vertex) const {
    const Vec3 mirrored = sp.frame.to_world({-sp.wo_local.x, -sp.wo_local.y, sp.wo_local.z});
    const uint64_t chosen = context.first_light.chosen[pixel];
    vertex.scatter = chosen == 0 ? mirrored : unpack_direction(static_cast<uint32_t>(chosen));
    Rgb f = eval_pdf(sp, vertex.scatter).f;
    if (is_black(f)) {  // a splat on another surface in the pixel
      vertex.scatter = mirrored;
      f = eval_pdf(sp, mirrored).f;
    }
    Rgb medium = context.scene().camera_medium;
    const Rgb arriving = transmittance_to(context.scene(), sp, hit.t, medium);
    for (int c = 0; c < 3; ++c) {
      const float reflected = radiance[pixel][c] - arriving[c] * sp.emission[c];
      const float divisor = arriving[c] * f[c];
      vertex.indirect[c] = reflected > 0.0f && divisor > 0.0f ? reflected / divisor : 0.0f;
    }
  }
};

}  // namespace relume
