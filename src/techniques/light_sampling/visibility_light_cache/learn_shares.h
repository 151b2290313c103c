// Updates what regions learn from the outcomes of their shadow rays.
#pragma once

#include "core/fixed_point.h"
#include "core/math.h"
#include "frame/group.h"
#include "techniques/light_sampling/visibility_light_cache/build_cache.h"

namespace relume {

/// Updates the shares of each region. Earlier frames count as kEarlier rays. A ray counts by the weight of its record,
/// in fixed point. One group per region.
///
/// Visibility: the fraction of shadow rays towards a light at infinity that reached it.
///
/// Exploration: the fraction of visible light that comes from lights off the list. A light found by the rays that
/// explore, a fraction ε, stands for 1 / ε samples; one of the list for 1 / (1 − ε).
struct LearnSharesKernel {
  static constexpr uint32_t kThreads = 128;
  static constexpr float kEarlier = 64;
  static constexpr float kLeastVisibility = 1.0f / 256;
  static constexpr float kMostExploration = 0.5f;
  static constexpr float kUnitsPerRay = 16;
  struct Shared {  // numbers of rays, in units
    uint32_t tried[InfinityVisibility::kCount];
    uint32_t seen[InfinityVisibility::kCount];
    uint32_t listed;  ///< rays that reached lights of the list
    uint32_t found;   ///< rays that reached others
  };

  SampleGroupsView samples;
  LightId first_infinite = 0;
  uint32_t light_count = 0;  ///< ids from this one on are ignored
  uint32_t max_samples = 0;  ///< maximum number read per region, spread evenly over its samples
  LearnedExploration exploration;
  View<const LightList> old_lists;  ///< those that the rays sampled
  View<const uint32_t> old_lights;
  View<const LightShares> old;  ///< empty: none
  View<LightShares> shares;

  template <typename Group>
  RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t region, uint32_t) const {
    group.each(InfinityVisibility::kCount, [&](uint32_t k) {
      shared.tried[k] = shared.seen[k] = 0;
      shared.listed = shared.found = 0;
    });
    const uint32_t read = relume::min(samples.counts[region], max_samples);
    group.each(read, [&](uint32_t i) { count(shared, region, sample_at(region, i, read), read); });
    group.each(1, [&](uint32_t) { finish(shared, region); });
  }

 private:
  RELUME_HD const VertexSample& sample_at(uint32_t region, uint32_t i, uint32_t read) const {
    return samples.sample(region, static_cast<uint32_t>(uint64_t{i} * samples.counts[region] / read));
  }

  /// Units of a record, of which `read` are added: their sum fits into 32 bits.
  RELUME_HD static uint32_t units_of(const VertexSample& sample, uint32_t read) {
    const float most = static_cast<float>(0x80000000u / read);
    return math::truncate_to_uint(relume::min(sample.weight * kUnitsPerRay + 0.5f, most));
  }
  RELUME_HD static float rays(uint32_t units) { return static_cast<float>(units) / kUnitsPerRay; }

  RELUME_HD void count(Shared& shared, uint32_t region, const VertexSample& sample, uint32_t read) const {
    const LightId id = sample.light & ~kVisibleLight;
    if (sample.light == kNoLight || id >= light_count) return;
    const bool visible = (sample.light & kVisibleLight) != 0;
    const uint32_t units = units_of(sample, read);
    if (visible && exploration.learns) atomic_add(is_listed(region, id) ? &shared.listed : &shared.found, units);
    if (id < first_infinite) return;
    const uint32_t k = InfinityVisibility::index_of(id - first_infinite);
    atomic_add(&shared.tried[k], units);
    if (visible) atomic_add(&shared.seen[k], units);
  }

  RELUME_HD LightList list_of(uint32_t region) const {
    return region < old_lists.size ? old_lists[region] : LightList{};
  }

  /// Binary search in the list, which is sorted by id.
  RELUME_HD bool is_listed(uint32_t region, LightId id) const {
    const LightList list = list_of(region);
    uint32_t low = 0;
    uint32_t high = list.count;
    while (low < high) {
      const uint32_t middle = (low + high) / 2;
      const LightId here = CachedLight::id(old_lights[list.first + middle]);
      if (here == id) return true;
      if (here < id) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return false;
  }

  RELUME_HD void finish(const Shared& shared, uint32_t region) const {
    LightShares result;
    result.exploration = exploration.start;
    if (region < old.size) result = old[region];
    for (uint32_t k = 0; k < InfinityVisibility::kCount; ++k) {
      float& visible = result.visibility.of[k];
      visible = (kEarlier * visible + rays(shared.seen[k])) / (kEarlier + rays(shared.tried[k]));
      visible = relume::max(visible, kLeastVisibility);
    }
    if (exploration.learns) result.exploration = explore_by(shared, region, result.exploration);
    shares[region] = result;
  }

  RELUME_HD float explore_by(const Shared& shared, uint32_t region, float before) const {
    const float listed = rays(shared.listed);
    const float found = rays(shared.found);
    float unlisted = 0;  // fraction of visible light
    if (list_of(region).count == 0) {
      unlisted = 1;  // all rays explored
    } else if (found > 0.0f) {
      const float rare = found / before;
      unlisted = rare / (rare + listed / (1.0f - relume::min(before, kMostExploration)));
    }
    const float reached = listed + found;
    const float next = (kEarlier * before + reached * unlisted) / (kEarlier + reached);
    return clamp(next, exploration.floor, relume::max(kMostExploration, exploration.floor));
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
