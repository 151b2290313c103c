// Candidates of reservoirs of paths without reuse, for tests of their light.
#pragma once

#include <vector>

#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/reuse/restir_pt/path_candidates.h"

namespace relume::testing {

/// Adds the light of each pixel's candidate to `radiance`. `context`: choices that learn; uniform selection does not.
/// Fixed selection is by a light tree, else uniform. `recording`: gives regions to vertices.
inline void add_candidates(PathContext context, const SampleIndex& index, const View<const Hit>& hits,
                           const PathRecording& recording, uint32_t width, std::vector<Rgb>& radiance) {
  const LightTreeData tree = build_light_tree(context.scene.lights);
  context.selector.tree = tree.view(context.scene.lights);
  std::vector<PathReservoir> reservoirs(radiance.size());
  std::vector<ReceiverRecord> receivers(radiance.size());
  std::vector<uint32_t> rays(radiance.size());
  PathCandidateKernel<LearnedChoices, PlainSuffix> kernel;
  kernel.context = context;
  kernel.rule.least_footprint = RestirPtSettings{}.footprint;
  kernel.index = index;
  kernel.index.frame = index.sample;
  kernel.hits = hits;
  kernel.reservoirs = mutable_view_of(reservoirs);
  kernel.records = mutable_view_of(receivers);
  kernel.image = {mutable_view_of(radiance), {}, mutable_view_of(rays)};
  kernel.width = width;
  kernel.choices.samples = recording;
  kernel.choices.records_samples = true;
  kernel.choices.learns_lights = context.selector.kind != LightSelectorKind::uniform;
  for (uint32_t p = 0; p < radiance.size(); ++p) {
    kernel(p % width, p / width);
    radiance[p] += reservoirs[p].sample.value * reservoirs[p].weight;
  }
}

}  // namespace relume::testing
