// Counts the records that the estimators of a region learn from.
#pragma once

#include "core/fixed_point.h"
#include "frame/group.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

/// Records that estimators read.
struct RecordUsers {
  bool lights = true;            ///< lights that a shadow ray reached
  bool infinite_lights = false;  ///< also those at infinity
  bool directions = true;        ///< directions from which light came
  bool importance = false;       ///< directions from which importance came
};

/// Writes the number of a region's useful records: those of the estimator that can use most. A record is useful to a
/// light cache if its shadow ray reached a light, to path guiding if light came along its direction, and to that of
/// light subpaths if importance arrived. The estimators of [Dittebrandt20, §6.2] have separate samples, too. One group
/// per region.
struct CountUsefulSamplesKernel {
  static constexpr uint32_t kThreads = 128;
  struct Shared {
    uint32_t lights;
    uint32_t directions;
    uint32_t importance;
  };

  SampleGroupsView samples;
  RecordUsers users;
  LightId first_infinite = 0;
  View<uint32_t> useful;  ///< by region

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const {
    group.each(1, [&](uint32_t) { shared.lights = shared.directions = shared.importance = 0; });
    group.each(samples.counts[region], [&](uint32_t i) {
      const VertexSample& sample = samples.sample(region, i);
      if (has_light(sample)) atomic_add(&shared.lights, 1u);
      if (has_direction(sample)) atomic_add(&shared.directions, 1u);
      if (has_importance(region, i)) atomic_add(&shared.importance, 1u);
    });
    group.each(1, [&](uint32_t) {
      useful[region] = relume::max(relume::max(shared.lights, shared.directions), shared.importance);
    });
  }

  void on_host(uint32_t region, uint32_t) const {
    uint32_t lights = 0;
    uint32_t directions = 0;
    uint32_t importance = 0;
    for (uint32_t i = 0; i < samples.counts[region]; ++i) {
      const VertexSample& sample = samples.sample(region, i);
      if (has_light(sample)) ++lights;
      if (has_direction(sample)) ++directions;
      if (has_importance(region, i)) ++importance;
    }
    useful[region] = relume::max(relume::max(lights, directions), importance);
  }

 private:
  RELUME_HD bool has_light(const VertexSample& sample) const {
    if (!users.lights || sample.light == kNoLight || !(sample.light & kVisibleLight)) return false;
    return users.infinite_lights || (sample.light & ~kVisibleLight) < first_infinite;
  }
  RELUME_HD bool has_importance(uint32_t region, uint32_t i) const {
    return users.importance && !samples.importance.empty() &&
           samples.importance[samples.address(region, i)].value > 0.0f;
  }
  RELUME_HD bool has_direction(const VertexSample& sample) const { return users.directions && sample.value > 0.0f; }
};

}  // namespace relume
