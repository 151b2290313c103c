// Output of paths that fill cells, for histories that verify a pixel for another viewpoint: the first vertex of each
// path, and whether cells show the light that it reflects.
#pragma once

#include "techniques/radiance_cache/path_space_filter/cell_paths.h"
#include "techniques/transport/path/first_vertex.h"

namespace relume {

/// The policy of a cache, followed by the record of the first vertex, which sees the path as the cache has changed it.
template <typename Cache>
struct VerifiedCellPath : PathPolicies<typename Cache::Policy, FirstVertexPolicy> {
  using Policies = PathPolicies<typename Cache::Policy, FirstVertexPolicy>;

  bool at_hit = false;  ///< whether the path left the filtered vertex at its first scattering event
  Rgb mirrored{0};      ///< throughput at the first surface · BSDF for the direction of mirror reflection

  RELUME_HD FirstVertexPolicy& record() { return this->others.first; }

  /// Records the direction of mirror reflection for paths that end here: reflection depends most on the view there.
  template <typename Earlier>
  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path, Earlier& earlier) {
    if (path.bounce == 0 && !is_lambert(sp.bsdf)) {
      const Vec3 direction = sp.frame.to_world({-sp.wo_local.x, -sp.wo_local.y, sp.wo_local.z});
      record().vertex->scatter = direction;
      mirrored = path.throughput * eval_pdf(sp, direction).f;
    }
    return Policies::arrived(sp, path, earlier);
  }
  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& after, Earlier& earlier) {
    if (after.bounce == 1) at_hit = this->first.pixel().filtered;
    Policies::scattered(sp, s, after, earlier);
  }
  RELUME_HD void rebased(const Rgb& found, const Rgb& unit) { this->first.rebased(found, unit); }
};

/// As CellsOutput, with records of first vertices. `Cache::Policy` also has
///   found(path)    radiance that the finished path found since its filtered vertex, in units of its throughput there
template <typename Cache>
struct VerifiedCellsOutput {
  using Policy = VerifiedCellPath<Cache>;

  CellsOutput<Cache> cells;
  View<FirstVertex> first_vertices;
  View<uint32_t> cells_at_hit;  ///< 0 or 1

  RELUME_HD Policy policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    first_vertices[pixel] = {};
    FirstVertexPolicy record;
    record.vertex = &first_vertices[pixel];
    return {{cells.policy(index, x, y, pixel), {record, {}}}};
  }

  RELUME_HD void finish(uint32_t pixel, Policy& policy, const PathState& path) const {
    cells.finish(pixel, policy.first, path);
    const FilteredPixel& p = policy.first.pixel();
    FirstVertex& vertex = first_vertices[pixel];
    cells_at_hit[pixel] = p.filtered && (policy.at_hit || path.bounce == 0) ? 1u : 0u;
    // The path kept its units. Reservoirs may have taken light after the record was complete.
    if (!p.filtered) return policy.record().finish_with(path.radiance);
    // Paths that are followed represent those that are not.
    const float weight = 1.0f / p.survival;
    if (cells_at_hit[pixel] == 0) return policy.record().finish_with(p.unfiltered + p.traced * weight);
    if (path.bounce == 0 && !p.culled && length_squared(vertex.to_light) == 0.0f) {
      // The cell shows all light, and the path was not followed.
      for (int c = 0; c < 3; ++c)
        vertex.indirect[c] = policy.mirrored[c] > 0.0f ? p.traced[c] / policy.mirrored[c] : 0.0f;
      return;
    }
    policy.record().finish_with(policy.first.found(path));
    vertex.indirect *= weight;
    vertex.direct *= weight;
  }

  RELUME_HD void leave_out(uint32_t pixel) const {
    cells.leave_out(pixel);
    first_vertices[pixel] = {};
    cells_at_hit[pixel] = 0;
  }
};

/// Traces one path per pixel, fills the cells and records first vertices.
template <typename Cache>
using VerifiedCellPathsKernel = PathKernel<VerifiedCellsOutput<Cache>, ReservoirScatterOutput>;

/// Traces one path per pixel, fills the cells, and records first vertices, samples for regions and states for chains.
template <typename Cache>
using RecordedVerifiedCellPathsKernel =
    PathKernel<CachedRecordingOutput, CachedChainOutput, VerifiedCellsOutput<Cache>, ReservoirScatterOutput>;

}  // namespace relume
