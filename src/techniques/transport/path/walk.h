// One path traced by one thread. The functions of its steps are not inlined: each calls functions with large stacks,
// and a device's thread then stores only the variables of the current step beside those of the path.
#pragma once

#include "techniques/transport/path/resampled_light.h"

namespace relume {

/// arrive() for threads that store one point: `sp` is the previous vertex before, and the current one after.
template <typename Policy>
RELUME_HD_NOINLINE bool arrive(const PathContext& c, const Hit& hit, SurfacePoint& sp, PathState& path,
                               Policy& policy) {
  if (!hit.valid()) {
    policy.emitted(path, add_infinite_lights(c, sp, path));
    return false;
  }
  const Vec3 previous = sp.position;
  const Instance& instance = c.scene.instances[hit.instance];
  const bool weighted = c.next_event && !path.delta && instance.first_light != kNoLight;
  const float pmf = weighted ? c.selector.pmf(sp, light_of(instance, hit.primitive)) : 0.0f;
  return arrive_at_surface(
      c, hit, previous, [pmf](LightId) { return pmf; }, sp, path, policy);
}

/// Adds the light of the picked source, if nothing blocks it.
template <typename Policy>
RELUME_HD_NOINLINE void add_picked(const PathContext& c, const SurfacePoint& sp, PathState& path, const LightPick& pick,
                                   const Sampler& sampler, Policy& policy) {
  Connection connection;
  if (!connect_picked(c, sp, path, pick, sampler, connection)) return;
  ++path.rays;
  const bool visible = !occluded(c.scene, connection.ray, connection.ray_id);
  if (visible) path.radiance += connection.contribution;
  policy.connected(sp, path, connection, visible);
}

/// Next event estimation at a vertex.
template <typename Policy>
RELUME_HD_NOINLINE void add_direct_light(const PathContext& c, const SurfacePoint& sp, PathState& path,
                                         Sampler& sampler, Policy& policy) {
  const LightPick pick = pick_light_for<Policy>(c, sp, path, sampler);
  if (!(pick.pmf > 0.0f)) return;
  path_policy::light_picked(policy, sp, path, pick.id);
  add_picked(c, sp, path, pick, sampler, policy);
}

/// Samples the next direction. Returns false if the path ends here.
template <typename Policy>
RELUME_HD_NOINLINE bool continue_path(const PathContext& c, const SurfacePoint& sp, PathState& path, Sampler& sampler,
                                      Policy& policy) {
  const BsdfSample s = c.directions.sample(sp, sampler);
  if (!follow(c, sp, s, path, sampler)) return false;
  policy.scattered(sp, s, path);
  return true;
}

/// Nearest hit along the path's ray.
RELUME_HD_NOINLINE inline Hit next_hit(const PathContext& c, PathState& path, const Sampler& sampler) {
  ++path.rays;
  return intersect(c.scene, path.ray, ray_id_of(c, path, sampler));
}

/// Traces a path from the hit of its ray until it ends. `sp`: the vertex where the ray starts; then each vertex.
template <typename Policy>
RELUME_HD inline void walk(const PathContext& c, Hit hit, SurfacePoint& sp, PathState& path, Sampler& sampler,
                           Policy& policy) {
  for (;;) {
    if (!arrive(c, hit, sp, path, policy)) break;
    if constexpr (DecidesLater<Policy>) {
      if (!policy.goes_on(path)) break;
    }
    add_direct_light(c, sp, path, sampler, policy);
    if (!continue_path(c, sp, path, sampler, policy)) break;
    hit = next_hit(c, path, sampler);
  }
  policy.finished(path);
}

/// Traces one sample of pixel (x, y) from its primary hit.
template <typename Policy = NoPolicy>
RELUME_HD inline PathState trace_path(const PathContext& c, uint32_t x, uint32_t y, Sampler& sampler, const Hit& hit,
                                      Policy&& policy = Policy{}) {
  PathState path = start_path(c, x, y, sampler);
  SurfacePoint sp;
  sp.position = path.ray.origin;
  sp.bsdf.lobe_count = 0;  // the camera
  walk(c, hit, sp, path, sampler, policy);
  return path;
}

}  // namespace relume
