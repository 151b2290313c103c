// Results of light sampling.
#pragma once

#include "core/box.h"
#include "core/frame.h"
#include "core/key_time.h"
#include "core/vec.h"
#include "sampling/warp.h"

namespace relume {

/// Bounding sphere of the scene, metres; light from infinity enters through it.
struct SceneBounds {
  Vec3 center{0};
  float radius = 1;
};

/// A point on an emissive triangle.
struct EmitterPoint {
  Vec3 position{0};
  Vec2 barycentric{0};  ///< weights of vertices 1 and 2
  float time = kShutterMiddle;
};

/// Upper limit of selection weights. Powers may overflow, and a sum that is not finite would invalidate all
/// probabilities.
inline constexpr float kMostSelectionWeight = 1e30f;

/// Bounds of a finite light, the input of light hierarchies ([Conty18]).
struct LightExtent {
  Box box;
  Vec3 axis{0, 0, 1};
  double theta_o = -1;  ///< bound on the angle between normals and the axis; below zero: no normals
  double theta_e = 0;   ///< bound on the angle between emission and a normal
  bool two_sided = false;
  double intensity = 0;  ///< along a normal, W/sr
};

/// Light that arrives at a point from one sampled direction.
struct LightSample {
  Vec3 wi{0};
  float distance = 0;   ///< to the emitter; infinite for lights at infinity
  float clearance = 0;  ///< distance before the emitter at which rounding may already place a hit on it, metres
  Rgb radiance{0};      ///< delta lights: irradiance on a plane facing the light
  float pdf_w = 0;      ///< delta lights: 1
  bool delta = false;   ///< whether no other strategy can sample this light
  Vec3 position{0};     ///< on the emitter (finite lights)
  Vec3 normal{0};       ///< of the emitter; zero for point lights and lights at infinity
  Vec2 barycentric{0};

  RELUME_HD bool valid() const { return pdf_w > 0.0f && !is_black(radiance); }
};

/// A ray that leaves a light. The light path's throughput is le · cos / (pdf_a · pdf_w).
struct EmissionSample {
  Vec3 origin{0};
  float error = 0;      ///< bound on the rounding error of the origin, metres; 0 without a surface
  Vec3 direction{0};    ///< away from the light
  Vec3 normal{0};       ///< of the emitter; zero: point light
  Rgb le{0};            ///< radiance; point and spot lights: intensity; delta directional lights: irradiance
  float pdf_a = 0;      ///< of the origin (lights at infinity: on the disk facing the direction); 1 for point lights
  float pdf_w = 0;      ///< of the direction; 1 for delta directional lights
  float cos_theta = 1;  ///< between normal and direction; 1 without a normal
  bool delta_position = false;
  bool delta_direction = false;
  bool infinite = false;

  RELUME_HD bool valid() const { return pdf_a > 0.0f && pdf_w > 0.0f && !is_black(le); }
};

struct EmissionPdf {
  float pdf_a = 0;
  float pdf_w = 0;
};

/// Origin for light along `direction`, before the scene: uniform over the disk that covers the bounding sphere.
RELUME_HD inline Vec3 disk_origin(const SceneBounds& bounds, const Vec3& direction, const Vec2& u) {
  const Frame frame = make_frame(direction);
  const Vec2 d = disk_from_square(u);
  return bounds.center + bounds.radius * (d.x * frame.t + d.y * frame.b - direction);
}

/// pdf_a of disk_origin.
RELUME_HD inline float disk_origin_pdf(const SceneBounds& bounds) { return kInvPi / sqr(bounds.radius); }

/// Samples a ray from infinity through the scene. `towards` is the result of sample_li for the direction to the light.
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
