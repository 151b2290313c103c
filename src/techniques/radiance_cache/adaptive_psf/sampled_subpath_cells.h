// Camera subpaths of bidirectional estimators that fill cells, and leave the light beyond second vertices to
// reservoirs.
//
// Two policies change the subpath: that of the sample (subpath_samples.h), then that of the cell. The first returns the
// finished subpath without its sample, so the second adds only the rest to the cell of a primary hit: direct light, and
// light that the second vertex scatters by a delta lobe. As without reservoirs, the cell holds the part of this light
// for which camera subpaths find the primary hit. Splats keep the other part.
//
// PathEvents::rebased() passes the units of the cell to the sample. No later vertex of such a subpath is filtered
// (FilterContext::indirect_apart), so the sample returns the subpath in these units. From the second vertex on, the
// sample has units of its own, which depend on neither cell nor pixel. Its weights restart there. Only the weights of
// other light count the camera subpaths over which a cell averages.
#pragma once

#include "techniques/radiance_cache/adaptive_psf/subpath_cells.h"
#include "techniques/transport/bdpt/subpath_samples.h"

namespace relume {

/// The policy of the sample, followed by that of the cell.
struct SampledCellSubpath : PathPolicies<SubpathSamplePolicy, AdaptiveVertex> {
  static constexpr bool samples_indirect_light = true;

  // As SubpathSamplePolicy.

  RELUME_HD void weigh_vertex(const PathState& path, SubpathWeights& weights) { first.weigh_vertex(path, weights); }
  RELUME_HD void tried(const Connection& c) { first.tried(c); }
  RELUME_HD void weigh_onwards(const PathState& after, SubpathWeights& weights) const {
    first.weigh_onwards(after, weights);
  }
  RELUME_HD Rgb found_beside_sample(const PathState& path, const Rgb& with_sample) const {
    return first.found_beside_sample(path, with_sample);
  }
};

/// Output of camera subpaths, as SubpathCells. The context must have PathContext::indirect_to_reservoirs, and the
/// filter FilterContext::indirect_apart.
struct SampledSubpathCells {
  SubpathCells cells;
  IndirectSampleOutput samples;

  RELUME_HD SampledCellSubpath policy(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    return {{subpath_sample_policy(samples, index, x, y, pixel), {cells.policy(index, x, y, pixel), {}}}};
  }
  RELUME_HD void finish(uint32_t pixel, SampledCellSubpath& policy, const Rgb& seen) const {
    cells.finish(pixel, policy.others.first, seen);
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    cells.leave_out(pixel);
    samples.leave_out(pixel);
  }
};

}  // namespace relume
