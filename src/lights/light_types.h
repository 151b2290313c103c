// What sampling a light returns.
#pragma once

#include "core/box.h"
#include "core/frame.h"
#include "core/vec.h"
#include "sampling/warp.h"

namespace relume {

/// Sphere around everything, metres: where light from infinity enters.
struct SceneBounds {
  Vec3 center{0};
  float radius = 1;
};

/// A point on an emissive triangle.
struct EmitterPoint {
  Vec3 position{0};
  Vec2 barycentric{0};  ///< weights of vertices 1 and 2
};

/// Largest weight of a light. Powers may overflow, and a sum that is not finite would leave no light its place.
inline constexpr float kMostSelectionWeight = 1e30f;

/// Bounds of a finite light, from which hierarchies of lights are built ([Conty18]).
struct LightExtent {
  Box box;
  Vec3 axis{0, 0, 1};
  double theta_o = -1;  ///< normals lie within this angle of the axis; below zero: there are none
  double theta_e = 0;   ///< light leaves within this angle of a normal
  bool two_sided = false;
  double intensity = 0;  ///< W/sr along a normal
};

/// Light that arrives at a point from one sampled direction.
struct LightSample {
  Vec3 wi{0};
  float distance = 0;   ///< to the emitter; infinite for lights at infinity
  float clearance = 0;  ///< metres before it in which a ray may already meet the emitter, as it is rounded
  Rgb radiance{0};      ///< delta lights: irradiance on a plane that faces the light
  float pdf_w = 0;      ///< delta lights: 1
  bool delta = false;   ///< no other strategy can find this light
  Vec3 position{0};     ///< on the emitter (finite lights)
  Vec3 normal{0};       ///< of the emitter; zero for point lights and lights at infinity
  Vec2 barycentric{0};

  RELUME_HD bool valid() const { return pdf_w > 0.0f && !is_black(radiance); }
};

/// A ray that leaves a light. Throughput of the light path: le · cos / (pdf_a · pdf_w).
struct EmissionSample {
  Vec3 origin{0};
  float error = 0;      ///< bound of the origin's rounding, metres; 0 where nothing is met there
  Vec3 direction{0};    ///< away from the light
  Vec3 normal{0};       ///< of the emitter; zero: point light
  Rgb le{0};            ///< radiance; intensity for point and spot lights; irradiance for delta directional lights
  float pdf_a = 0;      ///< of the origin (on the disk that faces the direction for lights at infinity); 1 for points
  float pdf_w = 0;      ///< of the direction; 1 for delta directional lights
  float cos_theta = 1;  ///< between normal and direction; 1 where there is no normal
  bool delta_position = false;
  bool delta_direction = false;
  bool infinite = false;

  RELUME_HD bool valid() const { return pdf_a > 0.0f && pdf_w > 0.0f && !is_black(le); }
};

struct EmissionPdf {
  float pdf_a = 0;
  float pdf_w = 0;
};

/// Origin on the far side of the scene for light that travels along `direction`, uniform over the disk that covers the
/// bounding sphere.
RELUME_HD inline Vec3 disk_origin(const SceneBounds& bounds, const Vec3& direction, const Vec2& u) {
  const Frame frame = make_frame(direction);
  const Vec2 d = disk_from_square(u);
  return bounds.center + bounds.radius * (d.x * frame.t + d.y * frame.b - direction);
}

/// pdf_a of disk_origin.
RELUME_HD inline float disk_origin_pdf(const SceneBounds& bounds) { return kInvPi / sqr(bounds.radius); }

/// Light from infinity on its way through the scene: `towards` is the direction that sample_li chose to look at it.
RELUME_HD inline EmissionSample sample_le_from_infinity(const LightSample& towards, const SceneBounds& bounds,
                                                        const Vec2& u_position) {
  EmissionSample s;
  s.direction = -towards.wi;
  s.origin = disk_origin(bounds, s.direction, u_position);
  s.le = towards.radiance;
  s.pdf_a = disk_origin_pdf(bounds);
  s.pdf_w = towards.pdf_w;
  s.delta_direction = towards.delta;
  s.infinite = true;
  return s;
}

}  // namespace relume
