// Next event estimation that chooses among several lights at primary hits, by resampled importance sampling
// ([Bitterli20] alg. 3). With a radiance cache, the reuse "ris" has this form: the light belongs to the path, so the
// cell that replaces a part of the path takes it like that of any other connection.
#pragma once

#include "techniques/transport/path/path.h"

namespace relume {

/// Makes a connection to the picked light, as make_connection(). Not inlined, as the steps in walk.h.
RELUME_HD_NOINLINE inline bool connect_picked(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                              const LightPick& pick, const Sampler& sampler, Connection& connection) {
  return make_connection(c, sp, path, pick, sample_picked(c, sp, pick), sampler, connection);
}

/// Luminance that a connection to the picked light adds if nothing blocks it; 0 without a connection.
RELUME_HD_NOINLINE inline float unoccluded_light(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                                 const LightPick& pick, const Sampler& sampler) {
  Connection connection;
  const bool connects = connect_picked(c, sp, path, pick, sampler, connection);
  return connects ? luminance(connection.contribution) : 0.0f;
}

/// Starts a vertex, and chooses one of several lights there in proportion to unoccluded_light(). Each candidate has its
/// MIS weight against the direction of the path, and `factor` is the mean of the candidates over the chosen one: the
/// mean of the connection stays that of a single light. A candidate that is not finite is chosen for the pixel to
/// report.
RELUME_HD_NOINLINE inline LightPick resample_light(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                                   Sampler& sampler) {
  LightPick chosen;
  if (!start_vertex(c, sp, path, sampler)) return chosen;
  float target = 0;  // of the chosen light
  float sum = 0;
  for (uint32_t i = 0; i < c.light_candidates && is_finite(sum); ++i) {
    sampler.start_dimension(kCandidateDimension + i);
    const LightPick pick = pick_light(c, sp, sampler);
    const float light = unoccluded_light(c, sp, path, pick, sampler);
    if (light <= 0.0f) continue;
    sum += light;
    if (is_finite(sum) && sampler.next_1d() * sum >= light) continue;
    chosen = pick;
    target = light;
  }
  if (is_finite(sum) && target > 0.0f) chosen.factor = sum / (target * c.light_samples(path.bounce));
  sampler.start_dimension(kCameraDimensions + path.bounce * kDimensionsPerBounce + 1);  // of the next direction
  return chosen;
}

/// Starts a vertex, and selects the light of next event estimation there, if any, for a path with this policy.
template <typename Policy>
RELUME_HD inline LightPick pick_light_for(const PathContext& c, const SurfacePoint& sp, const PathState& path,
                                          Sampler& sampler) {
  if constexpr (kResamplesLights<Policy>) {
    if (path.bounce == 0 && c.light_candidates > 1) return resample_light(c, sp, path, sampler);
  }
  return pick_light_at(c, sp, path, sampler);
}

}  // namespace relume
