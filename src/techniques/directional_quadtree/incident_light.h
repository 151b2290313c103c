// The light that comes in at a point, direction by direction.
#pragma once

#include "techniques/path/path.h"

namespace relume {

/// Leaves out what next event estimation at the first vertex could have found.
struct KnownEmission : NoObserver {
  Rgb known{0};

  RELUME_HD void emitted(const PathState& path, bool lights_know) {
    if (path.bounce == 1 && lights_know) known = path.radiance;
  }
};

/// Estimate of the radiance that arrives at `sp` from `wi`, without what next event estimation at `sp` finds.
RELUME_HD inline Rgb incident_radiance(const PathContext& c, const SurfacePoint& sp, const Vec3& wi, Sampler& sampler) {
  PathState path;
  path.ray = sp.spawn_ray(wi);
  path.cone_width = sp.footprint;
  path.delta = false;
  path.pdf_w = 1.0f;  // only the ratio to next event estimation's, whose share is left out anyway
  path.bounce = 1;
  KnownEmission observer;
  SurfacePoint points[2];
  points[0] = sp;
  Hit hit = intersect(c.scene.accel, path.ray, sampler.ray_id());
  for (;;) {
    SurfacePoint& here = points[path.bounce & 1u];
    if (!arrive(c, hit, points[(path.bounce & 1u) ^ 1u], here, path, observer)) break;
    here.region = kNoRegion;
    Connection connection;
    if (connect(c, here, path, sampler, connection) && !occluded(c.scene.accel, connection.ray, connection.ray_id))
      path.radiance += connection.contribution;
    if (!continue_path(c, here, path, sampler)) break;
    hit = intersect(c.scene.accel, path.ray, sampler.ray_id());
  }
  return path.radiance - observer.known;
}

/// Adds a path's find times |cos θ| to each texel of an octahedral map of edge `edge`.
struct IncidentLightKernel {
  PathContext context;
  SurfacePoint point;
  SampleIndex index;
  uint32_t edge = 0;
  View<float> sums;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Sampler sampler = index.sampler(x, y);
    const Vec2 jitter = sampler.next_2d();
    const Vec2 at = (Vec2(static_cast<float>(x), static_cast<float>(y)) + jitter) / static_cast<float>(edge);
    const Vec3 wi = direction_from_square(at);
    if (glm::dot(wi, point.ng) <= 0.0f) return;
    const float found = luminance(incident_radiance(context, point, wi, sampler)) * shading_cosine(point, wi);
    if (is_finite(found)) sums[y * edge + x] += found;
  }
};

}  // namespace relume
