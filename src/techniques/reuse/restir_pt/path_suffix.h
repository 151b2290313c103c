// The light behind the vertex after a joint. Shifts keep it unchanged, so a radiance cache may find it: the path up to
// the joint stays one that can be repeated.
#pragma once

#include "techniques/radiance_cache/path_graphs/path_graphs.h"
#include "techniques/radiance_cache/sharc/cell_ends.h"
#include "techniques/reuse/restir_pt/path_walk.h"
#include "techniques/transport/path/walk.h"

namespace relume {

/// Without a cache, or with one whose cells belong to primary hits: every vertex has paths to light of its own.
struct PlainSuffix {
  static constexpr bool uses_cells = false;
};

/// Paths end in the first cell whose blur is hidden. Distances and cones begin at the joint.
struct SharcSuffix {
  static constexpr bool uses_cells = true;
  using Policy = CellEnd;

  CellEnds ends;

  /// The policy of a path that arrives at the vertex after a joint. `alpha`: of the joint's narrowest lobe.
  RELUME_HD CellEnd policy(const SampleIndex& index, uint32_t x, uint32_t y, float alpha) const {
    CellEnd policy(ends, index, x, y);
    policy.start_cone(alpha);
    return policy;
  }
};

/// Path graphs that begin at the vertex after the joint.
struct GraphSuffix {
  static constexpr bool uses_cells = true;
  using Policy = PathGraph;

  PathGraphContext graph;

  RELUME_HD PathGraph policy(const SampleIndex& index, uint32_t x, uint32_t y, float /*alpha*/) const {
    PathGraph policy(graph, index, x, y);
    policy.start_sample();
    return policy;
  }
};

namespace path_suffix {

/// Sets the path to units of the vertex where it has arrived. What it finds then depends on that vertex alone.
RELUME_HD inline void start(const SceneView& scene, const SurfacePoint& sp, PathState& path) {
  path.throughput = Rgb(1);
  path.radiance = Rgb(0);
  path.eta_scale = 1.0f;
  path.rr_reference = 1.0f;
  path.rays = 0;
  if (scene.disperses) disperse(scene, sp, sp.ng, TransportMode::radiance, path);
}

}  // namespace path_suffix

/// Radiance that the vertex of a walk reflects along the last segment, without its own emission. Traces the rest of the
/// path: the walk then is at its end, and `walk.path.rays` counts the rays. Weights of the wavelength are included.
/// `policy`: of the suffix, possibly after recorders.
template <typename Policy>
RELUME_HD inline Rgb light_behind(const PathContext& c, PathWalk& walk, Sampler& sampler, Policy& policy) {
  SurfacePoint& sp = walk.sp;
  PathState& path = walk.path;
  path_suffix::start(c.scene, sp, path);
  bool scatters = path.bounce < c.max_bounces && !sp.bsdf.empty() && policy.arrived(sp, path);
  while (scatters && policy.goes_on(path)) {
    add_direct_light(c, sp, path, sampler, policy);
    if (!continue_path(c, sp, path, sampler, policy)) break;
    scatters = arrive(c, next_hit(c, path, sampler), sp, path, policy);
  }
  policy.finished(path);
  return path.radiance;
}

}  // namespace relume
