// Second kernel of ReSTIR PT: combines the path of each pixel with the reservoir of its surface in the previous frame,
// by the generalised balance heuristic of [Lin22]. Pixels without a path keep that reservoir.
#pragma once

#include "techniques/reuse/reservoir/history_source.h"
#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/reuse/restir_pt/path_duplicates.h"
#include "techniques/reuse/restir_pt/path_shift.h"

namespace relume {

/// The combination with weights cᵢ / Σc, which needs no inverse shift. `before`: with its value in the domain of `now`;
/// `target`: p̂ there.
RELUME_HD inline PathReservoir combine_constant(const PathReservoir& now, const PathReservoir& before, float target,
                                                float u) {
  BasicCombination<StoredPath> combination;
  combination.add(now, 0, now.target, 0.0f);
  combination.add(before, 1, target, u);
  return combination.finish(1.0f, now.confidence + before.confidence);
}

struct PathTemporalKernel {
  PathShifter shifter;
  ReservoirHistory<StoredPath> history;
  View<const uint32_t> duplicates;  ///< in the history, by PathDuplicatesKernel; empty: not counted
  View<ReceiverRecord> records;
  View<PathReservoir> reservoirs;
  View<uint32_t> rays;
  SampledPixels sampled;
  PathCorrection correction = PathCorrection::exact;
  DuplicateLimit limit;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * shifter.width + x;
    if (!sampled.has(pixel)) return keep(x, y);
    const PathReservoir own = reservoirs[pixel];
    if (!(own.confidence > 0.0f)) return;
    const SampleIndex& index = shifter.index;
    ChoiceNumbers numbers(index.seed, index.frame, pixel, kChoosesPathHistory);
    const float u_source = numbers.next();
    const float u = numbers.next();
    const SceneView& scene = shifter.context.scene;
    const uint32_t source = history.find(scene, x, y, u_source);
    if (source == kNoSurface) return;
    const float cap = limit.at(history.cap, duplicates.empty() ? 0 : duplicates[source]);
    PathReservoir before = history.at(source, cap * own.confidence);
    if (!is_finite(before.weight)) return;
    if (before.weight > 0.0f && !exists(scene, before.sample, shifter.context.max_bounces)) return;
    reservoirs[pixel] = combine(pixel, own, before, source, u);
  }

 private:
  RELUME_HD void keep(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * shifter.width + x;
    const SceneView& scene = shifter.context.scene;
    ChoiceNumbers numbers(shifter.index.seed, shifter.index.frame, pixel, kChoosesPathHistory);
    PathReservoir& kept = reservoirs[pixel];
    history.keep(scene, x, y, numbers.next(), kept, records[pixel]);
    const bool refers = !(kept.weight > 0.0f) || exists(scene, kept.sample, shifter.context.max_bounces);
    if (!refers || !is_finite(kept.weight)) kept = {};
  }

  RELUME_HD PathReservoir combine(uint32_t pixel, const PathReservoir& own, PathReservoir& before, uint32_t source,
                                  float u) const {
    const SceneView& scene = shifter.context.scene;
    float here = 0;  // p̂ of `before`
    if (before.weight > 0.0f) {
      const ReceiverRecord& now = records[pixel];
      const Shifted shifted =
          shifter.shift(before.sample, scene.camera, scene.instances[now.hit.instance], now, true, rays[pixel]);
      move_to(shifted, before.sample);
      here = shifted.target;
    }
    if (correction == PathCorrection::constant) return combine_constant(own, before, here, u);
    const float there = own.weight > 0.0f ? old_target(own.sample, source, rays[pixel]) : 0.0f;
    const auto now_target = [here](const StoredPath&) { return here; };
    const auto before_target = [there](const StoredPath&) { return there; };
    return correction == PathCorrection::basic ? combine_basic(own, before, now_target, before_target, u)
                                               : combine_balanced(own, before, now_target, before_target, u);
  }

  /// p̂ of this pixel's path at the primary hit of a pixel in the previous frame.
  RELUME_HD float old_target(const StoredPath& path, uint32_t source, uint32_t& ray_count) const {
    const SceneView& scene = shifter.context.scene;
    const bool traced = correction != PathCorrection::basic;
    return shifter
        .shift(path, scene.previous_camera, history.instance_of(scene, source), history.records[source], traced,
               ray_count)
        .target;
  }
};

}  // namespace relume
