// Emitters: a closed list of kinds, dispatched by one switch. Every kind can be sampled from a receiving point
// (sample_li, pdf_li) and can emit rays (sample_le, pdf_le); power() is its emitted power.
#pragma once

#include "core/ray.h"
#include "core/view.h"
#include "lights/directional_light.h"
#include "lights/environment.h"
#include "lights/light_types.h"
#include "lights/point_light.h"
#include "lights/spot_light.h"
#include "lights/triangle_light.h"

namespace relume {

/// Index into LightsView::lights; stable while the scene's instances, meshes and lights stay the same.
using LightId = uint32_t;
inline constexpr LightId kNoLight = 0xffffffffu;

enum class LightKind : uint8_t { triangle, point, spot, directional, environment };
inline constexpr int kLightKindCount = 5;

struct Light {
  LightKind kind;
  bool changed;  ///< whether it moved, or its emission changed, since the previous frame
  union {
    TriangleLight triangle;
    PointLight point;
    SpotLight spot;
    DirectionalLight directional;
  };

  RELUME_HD Light() : kind(LightKind::environment), changed(false), point{} {}
  static Light of(const TriangleLight& light) { return made(LightKind::triangle, &Light::triangle, light); }
  static Light of(const PointLight& light) { return made(LightKind::point, &Light::point, light); }
  static Light of(const SpotLight& light) { return made(LightKind::spot, &Light::spot, light); }
  static Light of(const DirectionalLight& light) { return made(LightKind::directional, &Light::directional, light); }

 private:
  template <typename T>
  static Light made(LightKind kind, T Light::*member, const T& value) {
    Light light;
    light.kind = kind;
    light.*member = value;
    return light;
  }
};

/// Whether two lights have equal parameters; always true for two environments.
inline bool same_light(const Light& a, const Light& b) {
  if (a.kind != b.kind) return false;
  switch (a.kind) {
    case LightKind::triangle: return same_light(a.triangle, b.triangle);
    case LightKind::point: return a.point == b.point;
    case LightKind::spot: return a.spot == b.spot;
    case LightKind::directional: return a.directional == b.directional;
    case LightKind::environment: return true;
  }
  return true;
}

/// Spatial and angular bounds of a light with this selection weight; empty for lights at infinity.
inline LightExtent extent_of(const Light& light, double watts) {
  switch (light.kind) {
    case LightKind::triangle: return extent_of(light.triangle, watts);
    case LightKind::point: return extent_of(light.point, watts);
    case LightKind::spot: return extent_of(light.spot);
    case LightKind::directional:
    case LightKind::environment: break;
  }
  return {};
}

/// Central point of a finite light.
RELUME_HD inline Vec3 position_of(const Light& light) {
  switch (light.kind) {
    case LightKind::triangle: return light.triangle.position(light.triangle.centre());
    case LightKind::point: return light.point.position;
    case LightKind::spot: return light.spot.position;
    case LightKind::directional:
    case LightKind::environment: break;
  }
  return Vec3(0);
}

/// sample_li() of finite lights without extent; no sample for others.
RELUME_HD inline LightSample sample_li_from_point(const Light& light, const Vec3& p) {
  switch (light.kind) {
    case LightKind::point: return sample_li(light.point, p);
    case LightKind::spot: return sample_li(light.spot, p);
    case LightKind::triangle:
    case LightKind::directional:
    case LightKind::environment: break;
  }
  return {};
}

/// All emitters of a scene. Lights at infinity (directional, environment) come last.
struct LightsView {
  View<const Light> lights;
  View<const Light> previous;   ///< the same lights in the previous frame
  View<const LightId> changed;  ///< lights that differ from the previous frame
  uint32_t first_infinite = 0;
  TexturedEmission textured;
  EnvironmentView environment;
  SceneBounds bounds;
  View<const LightKey> keys;        ///< corners of emissive triangles that move while the shutter is open
  View<const uint32_t> first_keys;  ///< offset in `keys` by light, or kNoKeys; empty: all rest
  uint32_t key_count = 0;           ///< of each of these
  float wide_triangle =
      kWideTriangle;  ///< relative width above which triangles are sampled by solid angle; infinity: never
};

/// Whether the light moves while the shutter is open. Only emissive triangles do: other lights keep their place of the
/// middle. A hit on a moving triangle, or a sample of one, is at the time of its path.
RELUME_HD inline bool moves(const LightsView& view, LightId id) {
  return !view.first_keys.empty() && view.first_keys[id] != kNoKeys;
}
RELUME_HD inline TriangleLight moved_light(const LightsView& view, LightId id, float time) {
  return moved(view.lights[id].triangle, view.keys.data + view.first_keys[id], view.key_count, time);
}

// The functions below for moving lights. They are not inlined, and take values, so that lights at rest cost no
// registers or memory.

RELUME_HD_NOINLINE inline LightSample sample_li_moved(const LightsView& view, LightId id, Vec3 p, Vec2 u, float time) {
  return sample_li(moved_light(view, id, time), view.textured, p, u, view.wide_triangle);
}
RELUME_HD_NOINLINE inline float pdf_li_moved(const LightsView& view, LightId id, Vec3 p, Vec3 wi,
                                             EmitterPoint on_light) {
  return pdf_li(moved_light(view, id, on_light.time), view.textured, p, wi, on_light, view.wide_triangle);
}
RELUME_HD_NOINLINE inline EmissionSample sample_le_moved(const LightsView& view, LightId id, Vec2 u_position,
                                                         Vec2 u_direction, float time) {
  return sample_le(moved_light(view, id, time), view.textured, u_position, u_direction);
}
RELUME_HD_NOINLINE inline EmissionPdf pdf_le_moved(const LightsView& view, LightId id, EmitterPoint on_light,
                                                   Vec3 direction) {
  return pdf_le(moved_light(view, id, on_light.time), view.textured, on_light, direction);
}

/// Samples light that reaches `p` from one direction, at a time within the shutter.
RELUME_HD inline LightSample sample_li(const LightsView& view, LightId id, const Vec3& p, const Vec2& u,
                                       float time = kShutterMiddle) {
  if (moves(view, id)) return sample_li_moved(view, id, p, u, time);
  const Light& light = view.lights[id];
  switch (light.kind) {
    case LightKind::triangle: return sample_li(light.triangle, view.textured, p, u, view.wide_triangle);
    case LightKind::point: return sample_li(light.point, p);
    case LightKind::spot: return sample_li(light.spot, p);
    case LightKind::directional: return sample_li(light.directional, u);
    case LightKind::environment: return sample_li(view.environment, u);
  }
  return {};
}

/// The same for the light's state in the previous frame, with the current textures and environment.
RELUME_HD inline LightSample sample_li_before(const LightsView& view, LightId id, const Vec3& p, const Vec2& u) {
  LightsView before = view;
  before.lights = view.previous;
  before.first_keys = {};
  return sample_li(before, id, p, u);
}

/// pdf_w with which sample_li(id, p) samples direction `wi`; 0 for delta lights. For triangles, `on_light` is the point
/// hit along wi, with its time (others ignore it).
RELUME_HD inline float pdf_li(const LightsView& view, LightId id, const Vec3& p, const Vec3& wi,
                              const EmitterPoint& on_light) {
  if (moves(view, id)) return pdf_li_moved(view, id, p, wi, on_light);
  const Light& light = view.lights[id];
  switch (light.kind) {
    case LightKind::triangle: return pdf_li(light.triangle, view.textured, p, wi, on_light, view.wide_triangle);
    case LightKind::point:
    case LightKind::spot: return 0.0f;
    case LightKind::directional: return pdf_li(light.directional, wi);
    case LightKind::environment: return pdf_li(view.environment, wi);
  }
  return 0.0f;
}

/// Radiance from a light at infinity that arrives along −wi.
RELUME_HD inline Rgb radiance_from_infinity(const LightsView& view, LightId id, const Vec3& wi) {
  const Light& light = view.lights[id];
  return light.kind == LightKind::directional ? radiance_from(light.directional, wi) : view.environment.radiance(wi);
}

/// Samples a ray that leaves the light at a time within the shutter, with the densities of its origin and direction.
RELUME_HD inline EmissionSample sample_le(const LightsView& view, LightId id, const Vec2& u_position,
                                          const Vec2& u_direction, float time = kShutterMiddle) {
  if (moves(view, id)) return sample_le_moved(view, id, u_position, u_direction, time);
  const Light& light = view.lights[id];
  switch (light.kind) {
    case LightKind::triangle: return sample_le(light.triangle, view.textured, u_position, u_direction);
    case LightKind::point: return sample_le(light.point, u_direction);
    case LightKind::spot: return sample_le(light.spot, u_direction);
    case LightKind::directional:
    case LightKind::environment:
      return sample_le_from_infinity(sample_li(view, id, Vec3(0), u_direction), view.bounds, u_position);
  }
  return {};
}

/// Densities with which sample_le emits along `direction` (away from the light) from `on_light`.
RELUME_HD inline EmissionPdf pdf_le(const LightsView& view, LightId id, const EmitterPoint& on_light,
                                    const Vec3& direction) {
  if (moves(view, id)) return pdf_le_moved(view, id, on_light, direction);
  const Light& light = view.lights[id];
  switch (light.kind) {
    case LightKind::triangle: return pdf_le(light.triangle, view.textured, on_light, direction);
    case LightKind::point: return pdf_le(light.point);
    case LightKind::spot: return pdf_le(light.spot, direction);
    case LightKind::directional:
    case LightKind::environment: return {disk_origin_pdf(view.bounds), pdf_li(view, id, Vec3(0), -direction, {})};
  }
  return {};
}

/// Emitted power in watts; for lights at infinity, the power through the scene's bounding sphere.
RELUME_HD inline Rgb power(const LightsView& view, LightId id) {
  const Light& light = view.lights[id];
  switch (light.kind) {
    case LightKind::triangle: return power(light.triangle, view.textured);
    case LightKind::point: return power(light.point);
    case LightKind::spot: return power(light.spot);
    case LightKind::directional: return power(light.directional, view.bounds);
    case LightKind::environment: return power(view.environment, view.bounds);
  }
  return Rgb(0);
}

/// Weight for selection by power: the luminance of the power in watts, clamped to be finite.
RELUME_HD inline float selection_weight(const LightsView& view, LightId id) {
  return relume::min(luminance(power(view, id)), kMostSelectionWeight);
}

}  // namespace relume
