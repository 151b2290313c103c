// Incident radiance at a point by direction.
#pragma once

#include "techniques/transport/path/walk.h"

namespace relume {

/// Excludes light that next event estimation at the first vertex could sample, and guides no direction.
struct IncidentPolicy : NoPolicy {
  Rgb nee_radiance{0};

  RELUME_HD void emitted(const PathState& path, bool covered_by_nee) {
    if (path.bounce == 1 && covered_by_nee) nee_radiance = path.radiance;
  }
  RELUME_HD bool arrived(SurfacePoint& sp, PathState&) {
    sp.region = kNoRegion;
    return true;
  }
};

/// Estimate of the incident radiance at `sp` from `wi`, without light that next event estimation at `sp` samples. The
/// path overwrites `sp`.
RELUME_HD inline Rgb incident_radiance(const PathContext& c, SurfacePoint& sp, const Vec3& wi, Sampler& sampler) {
  PathState path;
  path.ray = sp.spawn_ray(wi);
  path.cone_width = sp.footprint;
  path.wavelength_nm = path_wavelength(c.scene, sampler);
  path.delta = false;
  path.pdf_w = 1.0f;  // only affects the MIS weight of light that is excluded
  path.bounce = 1;
  IncidentPolicy policy;
  walk(c, intersect(c.scene, path.ray, sampler.ray_id()), sp, path, sampler, policy);
  return path.radiance - policy.nee_radiance;
}

/// The point whose directions are shown.
struct ViewedPoint {
  Ray ray;               ///< to the point
  Hit hit;               ///< invalid: the pixel has no hit
  float cone_width = 0;  ///< of the ray at the point, metres
  uint32_t region = kNoRegion;

  RELUME_HD void make_surface(const SceneView& scene, SurfacePoint& point) const {
    make_surface_point(scene, ray, hit, cone_width, point);
    point.region = region;
  }
};

/// Adds the incident luminance of one path times |cos θ| to each texel of an octahedral map of edge `edge`.
struct IncidentLightKernel {
  PathContext context;
  View<const ViewedPoint> viewed;  ///< one element
  SampleIndex index;
  uint32_t edge = 0;
  View<float> sums;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Sampler sampler = index.sampler(x, y);
    const Vec2 jitter = sampler.next_2d();
    const Vec2 at = (Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter) / static_cast<float>(edge);
    const Vec3 wi = direction_from_square(at);
    SurfacePoint point;
    viewed[0].make_surface(context.scene, point);
    if (glm::dot(wi, point.ng) <= 0.0f) return;
    const float cosine = shading_cosine(point, wi);
    const float found = luminance(incident_radiance(context, point, wi, sampler)) * cosine;
    if (is_finite(found)) sums[y * edge + x] += found;
  }
};

}  // namespace relume
