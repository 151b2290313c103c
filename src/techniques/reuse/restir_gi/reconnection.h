// The shift of ReSTIR GI: another receiver connects to the vertex of a sample ([Ouyang21]). Integrands and weights
// are per area at the vertex, so the shift keeps the sample, and the Jacobian of [Ouyang21 eq. 11] is the ratio of two
// geometry terms.
#pragma once

#include "scene/surface_place.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reservoir.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {

using IndirectReservoir = Reservoir<IndirectVertex>;

/// Purposes of ChoiceNumbers.
inline constexpr uint32_t kChoosesIndirectHistory = 0x47490001u;
inline constexpr uint32_t kChoosesIndirectNeighbours = 0x47490002u;
inline constexpr uint32_t kChoosesIndirectRecord = 0x47490003u;

/// Place of an existing vertex; `front` is the normal on its lit side.
RELUME_HD inline SurfacePlace place_of(const SceneView& scene, const Instance& instance, const IndirectVertex& vertex) {
  SurfacePlace place = surface_place(scene, instance, vertex.hit());
  if (!vertex.has(IndirectVertex::kFrontFace)) place.front = -place.front;
  return place;
}
RELUME_HD inline SurfacePlace place_of(const SceneView& scene, const IndirectVertex& vertex) {
  return place_of(scene, scene.instances[vertex.instance], vertex);
}

/// Maps the vertex's normal by `turn`, the change of vectors at its surface between two placements.
RELUME_HD inline void turn_normal(const Mat3& turn, IndirectVertex& vertex) {
  if (turn == Mat3(1)) return;
  const Vec3 n = turn * unpack_direction(vertex.normal);
  const float length = glm::length(n);
  if (length > 0.0f && is_finite(length)) vertex.normal = pack_direction(n / length);
}

/// The segment from a receiver to a vertex.
struct Reconnection {
  Vec3 wi{0};          ///< from the receiver, unit
  float distance = 0;  ///< metres
  float cosine = 0;    ///< at the vertex, to its lit side; 0: the receiver is behind it

  /// Solid angle at the receiver per area at the vertex, 1/m².
  RELUME_HD float geometry() const { return cosine > 0.0f ? cosine / sqr(distance) : 0.0f; }
};

RELUME_HD inline Reconnection reconnect(const Vec3& receiver, const SurfacePlace& vertex) {
  Reconnection c;
  const Vec3 d = vertex.position - receiver;
  c.distance = glm::length(d);
  if (!(c.distance > 0.0f)) return c;
  c.wi = d / c.distance;
  c.cosine = relume::max(-glm::dot(c.wi, vertex.front), 0.0f);
  return c;
}

/// Light that the receiver reflects to the camera from a vertex of this radiance: per area at the vertex, without
/// occlusion, media and the path's throughput.
RELUME_HD inline Rgb reflected_from(const SceneView& scene, const Receiver& r, const Reconnection& c,
                                    const Rgb& radiance) {
  const float geometry = c.geometry();
  if (!(geometry > 0.0f)) return Rgb(0);
  const BsdfEval bsdf = eval_pdf(r.sp, c.wi);
  if (is_black(bsdf.f)) return Rgb(0);
  Rgb value = bsdf.f * radiance * (shading_cosine(r.sp, c.wi) * geometry);
  if (scene.disperses) value *= dispersion_weight(scene, r.sp, c.wi, r.path);
  return value;
}

/// p̂ without occlusion: the luminance of the vertex's light, times that of the light that the receiver reflects from a
/// white vertex. The ratio of two receivers' targets, and thus every MIS weight, is independent of the light. Its
/// distribution may differ between frames, as where light selection learns, without bias.
RELUME_HD inline float target_from(const SceneView& scene, const Receiver& r, const Reconnection& c,
                                   const Rgb& radiance) {
  return luminance(reflected_from(scene, r, c, Rgb(1))) * luminance(radiance);
}

/// Whether nothing blocks the receiver's view of a vertex; the same for the same receiver and vertex, also behind
/// stochastic alpha. `error`: of the vertex, as in SurfacePlace.
RELUME_HD inline bool sees(const SceneView& scene, const Receiver& r, const Reconnection& c, float error) {
  Ray ray = shadow_ray(r.sp, c.wi, c.distance);
  const float clearance = 2.0f * error / relume::max(c.cosine, 1e-3f);
  ray.t_max = relume::min(ray.t_max, relume::max(c.distance - clearance, 0.0f));
  return !occluded(scene, ray, r.ray_id);
}

/// Position of a record's hit in its frame. Jacobians use this position in both directions.
RELUME_HD inline Vec3 position_of(const ReceiverRecord& record) {
  return record.origin + record.direction * record.hit.t;
}

/// Rules by which samples move between receivers.
struct ReconnectionRule {
  float least_alpha = 0;          ///< of glossy lobes
  bool reuses_glossy = false;     ///< whether vertices with such lobes count as Lambertian
  float largest_jacobian = 1e6f;  ///< at least 1

  /// Whether pixels of this surface reuse samples.
  RELUME_HD bool receives(const SurfacePoint& sp) const { return narrowest_alpha(sp.bsdf) >= least_alpha; }

  /// Whether the sample can be reused: a property of the sample alone.
  RELUME_HD bool moves(const IndirectVertex& vertex) const {
    if (vertex.has(IndirectVertex::kBound)) return false;
    return vertex.has(IndirectVertex::kLambert) ||
           (reuses_glossy && vertex.alpha > 0.0f && vertex.alpha >= least_alpha);
  }

  /// Whether a sample with these geometry terms at two receivers moves between them. Symmetric: a rule that refused one
  /// direction only would add bias.
  RELUME_HD bool connects(float a, float b) const {
    return a > 0.0f && b > 0.0f && a <= largest_jacobian * b && b <= largest_jacobian * a;
  }
};

/// p̂ at a receiver of a sample that moved there: target_from(), 0 behind occluders if `traced`. Zero where the vertex
/// could reflect other light than to its own receiver: seen below the horizon of its shading normal, or through a
/// medium. Adds traced rays to `rays`.
RELUME_HD inline float moved_target(const SceneView& scene, const Receiver& r, const IndirectVertex& vertex,
                                    const SurfacePlace& place, bool traced, uint32_t& rays) {
  const Reconnection c = reconnect(r.sp.position, place);
  if (!(-glm::dot(unpack_direction(vertex.normal), c.wi) >= kLeastVertexCosine)) return 0.0f;
  if (scene.absorbs && !is_black(medium_along(scene, r.sp, c.wi, r.path.medium))) return 0.0f;
  const float target = target_from(scene, r, c, vertex.radiance);
  if (!(target > 0.0f)) return 0.0f;
  if (!traced) return target;
  ++rays;
  return sees(scene, r, c, place.error) ? target : 0.0f;
}

}  // namespace relume
