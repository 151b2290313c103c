// What a region learns from the outcomes of its shadow rays.
#pragma once

#include "core/fixed_point.h"
#include "frame/group.h"
#include "techniques/light_sampling/light_selection/weighed_lights.h"
#include "techniques/spatial/octree/sample_stream.h"

namespace relume {

struct LightShares {
  InfinityVisibility visibility = {{0.5f, 0.5f, 0.5f, 0.5f}};  ///< > 0, at most 1

  bool valid() const {
    for (const float visible : visibility.of)
      if (!(visible > 0.0f && visible <= 1.0f)) return false;
    return true;
  }
};

/// Updates the visibility of lights at infinity in each region: the fraction of unblocked shadow rays, where earlier
/// frames count as kEarlier rays. One group per region.
struct LearnSharesKernel {
  static constexpr uint32_t kThreads = 128;
  static constexpr float kEarlier = 64;
  static constexpr float kLeastVisibility = 1.0f / 256;
  struct Shared {
    uint32_t tried[InfinityVisibility::kCount];
    uint32_t seen[InfinityVisibility::kCount];
  };

  SampleGroupsView samples;
  LightId first_infinite = 0;
  uint32_t max_samples = 0;     ///< maximum number read per region, spread evenly over its samples
  View<const LightShares> old;  ///< empty: none
  View<LightShares> shares;

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const {
    group.each(InfinityVisibility::kCount, [&](uint32_t k) { shared.tried[k] = shared.seen[k] = 0; });
    const uint32_t read = relume::min(samples.counts[region], max_samples);
    group.each(read, [&](uint32_t i) { count(shared, light_at(region, i, read)); });
    group.each(1, [&](uint32_t) { finish(shared, region); });
  }

 private:
  RELUME_HD uint32_t light_at(uint32_t region, uint32_t i, uint32_t read) const {
    return samples.sample(region, static_cast<uint32_t>(uint64_t{i} * samples.counts[region] / read)).light;
  }

  RELUME_HD void count(Shared& shared, uint32_t light) const {
    const LightId id = light & ~kVisibleLight;
    if (light == kNoLight || id < first_infinite) return;
    const uint32_t k = InfinityVisibility::index_of(id - first_infinite);
    atomic_add(&shared.tried[k], 1u);
    if (light & kVisibleLight) atomic_add(&shared.seen[k], 1u);
  }

  RELUME_HD void finish(const Shared& shared, uint32_t region) const {
    LightShares result = region < old.size ? old[region] : LightShares{};
    for (uint32_t k = 0; k < InfinityVisibility::kCount; ++k) {
      float& visible = result.visibility.of[k];
      visible = (kEarlier * visible + static_cast<float>(shared.seen[k])) /
                (kEarlier + static_cast<float>(shared.tried[k]));
      visible = relume::max(visible, kLeastVisibility);
    }
    shares[region] = result;
  }
};

/// Copies the shares of each region's origin.
struct InheritSharesKernel {
  View<const uint32_t> previous;  ///< origin by region
  View<const LightShares> old;
  View<LightShares> shares;

  RELUME_HD void operator()(uint32_t region, uint32_t) const {
    const uint32_t from = previous[region];
    shares[region] = from < old.size ? old[from] : LightShares{};
  }
};

}  // namespace relume
