// A point of a light source, independent of the receiver: the sample of reservoirs for direct light. Other pixels and
// frames reuse it unchanged (identity shift) and without a Jacobian, because densities are per unit of its coordinates.
#pragma once

#include "core/octahedral.h"
#include "lights/light.h"

namespace relume {

struct LightPoint {
  LightId light = kNoLight;
  Vec2 coordinates{0};  ///< triangle or parallelogram: barycentrics; light with extent at infinity: octahedral
                        ///< direction in [-1, 1]²; other lights: unused

  RELUME_HD bool valid() const { return light != kNoLight; }
};

/// The point of a sample that sample_li() drew from `light`.
RELUME_HD inline LightPoint point_of(const LightsView& view, LightId light, const LightSample& sample) {
  if (light < view.first_infinite) return {light, sample.barycentric};
  return {light, sample.delta ? Vec2(0) : octahedral_from_direction(sample.wi)};
}

/// The point of a finite light that a ray from `p` along `w` meets. `barycentric`: of the hit on the triangle.
RELUME_HD inline LightPoint point_along(const LightsView& view, LightId light, const Vec3& p, const Vec3& w,
                                        const Vec2& barycentric) {
  const TriangleLight& triangle = view.lights[light].triangle;
  if (!triangle.is_parallelogram) return {light, barycentric};
  LightPoint point{light, Vec2(0)};
  barycentric_along(shape_at(triangle, triangle.v0 - p), triple_of<float>(w), point.coordinates.x, point.coordinates.y);
  return point;
}

/// Light that arrives at `p` from the point. `pdf_w` is one per unit of the coordinates' measure, converted to solid
/// angle: radiance · cos / pdf_w is the integrand per unit of that measure. Delta lights have pdf_w 1. Returns a sample
/// without light where the point does not illuminate `p`.
RELUME_HD inline LightSample light_at(const LightsView& view, const LightPoint& point, const Vec3& p) {
  const Light& light = view.lights[point.light];
  if (point.light < view.first_infinite) {
    if (light.kind != LightKind::triangle) return sample_li_from_point(light, p);
    const TriangleLight& triangle = light.triangle;
    const float area = triangle.is_parallelogram ? triangle.area : 2.0f * triangle.area;  // m² per unit
    return light_from(triangle, view.textured, p, point.coordinates, 1.0f / area, false);
  }
  if (light.kind == LightKind::directional && light.directional.delta()) return sample_li(light.directional, Vec2(0));
  LightSample s;
  s.wi = direction_from_octahedral(point.coordinates);
  s.distance = kInfinity;
  s.radiance = radiance_from_infinity(view, point.light, s.wi);
  s.pdf_w = 1.0f;
  return s;
}

/// Density of sample_li() at a sample of light_at(), per steradian; 1 for delta lights.
RELUME_HD inline float density_of(const LightsView& view, LightId light, const Vec3& p, const LightSample& sample) {
  return sample.delta ? 1.0f : pdf_li(view, light, p, sample.wi, {sample.position, sample.barycentric});
}

}  // namespace relume
